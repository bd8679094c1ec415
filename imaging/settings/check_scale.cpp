#include "imaging/settings/check_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/settings/configure_locator.hpp"

namespace twincell::imaging {

namespace {

/// What the beads of a frame cover, px^2, without the factor pi.
double covered(const std::vector<Detection>& beads) {
  double sum = 0;
  for (const Detection& b : beads) sum += b.radius * b.radius;
  return sum;
}

bool of_size(const Located& seen, double diameter_px) {
  constexpr double kOff = 0.05, kDropped = 0.2;  // of the diameter; of the beads
  if (static_cast<double>(seen.dropped.size()) > kDropped * static_cast<double>(seen.beads.size()))
    return false;
  if (seen.beads.empty()) return false;
  std::vector<double> diameters;
  for (const Detection& b : seen.beads) diameters.push_back(2 * b.radius);
  return std::abs(upper_median(std::move(diameters)) - diameter_px) <= kOff * diameter_px;
}

}  // namespace

std::string sizes_that_differ(const LocatorOptions& beads, double pixels_per_sigma) {
  constexpr double kOff = 0.1;
  double smallest = beads.diameter_px, largest = beads.diameter_px;
  for (const double other : beads.other_diameters_px) {
    smallest = std::min(smallest, other);
    largest = std::max(largest, other);
  }
  if (pixels_per_sigma >= (1 - kOff) * smallest && pixels_per_sigma <= (1 + kOff) * largest) return {};
  return largest > smallest ? fmt::format("{:.4g} to {:.4g}", smallest, largest)
                            : fmt::format("{:.4g}", smallest);
}

std::optional<std::string> check_beads_at_scale(FramesAhead& frames, const LocatorOptions& given,
                                                const StatedDiscs& cell, int threads) {
  constexpr double kNoLess = 0.95, kMore = 1.2;  // of the area that the stated discs cover
  const double scale = given.diameter_px;
  const cv::Mat* const first = frames.look(0);
  if (first == nullptr) return {};
  const Located stated = locate(*first, configure_locator(frames, given, threads).locator);
  if (of_size(stated, scale)) return {};
  LocatorOptions searched = given;
  searched.diameter_px = 0;
  searched.polarity_known = !cell.polarity_open;
  LocatorOptions found;
  try {
    found = configure_locator(frames, searched, threads).locator;
  } catch (const NoDiscs&) {
    return {};
  }
  const double by_stated = covered(stated.beads), by_found = covered(locate(*first, found).beads);
  if (const std::string sizes = sizes_that_differ(found, scale); !sizes.empty()) {
    // A wrong size found inside large beads covers less than they do.
    if (by_found < kNoLess * by_stated) return {};
    throw ConfigError(
        {.file = cell.file, .key = cell.key},
        fmt::format("is {:g}, but the beads in the frames are {} px wide, and sigma is the bead diameter; "
                    "correct the scale, or state the diameter of the beads (--diameter).",
                    scale, sizes));
  }
  if (by_found <= kMore * by_stated) return {};
  if (found.preprocess.bright && !given.preprocess.bright)
    throw ConfigError({.file = cell.file, .key = "camera.bright"},
                      "is absent or false, but the beads in the frames are brighter than their surroundings; "
                      "state camera.bright = true (or --dark if they are not).");
  if (!cell.refiner_open || found.refine.method == given.refine.method) return {};
  return found.refine.method;
}

}  // namespace twincell::imaging
