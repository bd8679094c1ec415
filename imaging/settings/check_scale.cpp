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

void check_bead_size(FramesAhead& frames, const LocatorOptions& given, const LocatorOptions& settled,
                     int threads) {
  constexpr double kNoLess = 0.95;
  const double scale = given.diameter_px;
  const cv::Mat* const first = frames.look(0);
  if (first == nullptr) return;
  const Located stated = locate(*first, settled);
  if (of_size(stated, scale)) return;
  LocatorOptions open = given;
  open.diameter_px = 0;
  LocatorOptions found;
  try {
    found = configure_locator(frames, open, threads).locator;
  } catch (const NoDiscs&) {
    return;
  }
  const std::string sizes = sizes_that_differ(found, scale);
  if (sizes.empty()) return;
  // A wrong size found inside large beads covers less than they do.
  if (covered(locate(*first, found).beads) < kNoLess * covered(stated.beads)) return;
  throw ConfigError(
      {.file = {}, .key = "camera.pixels_per_sigma"},
      fmt::format("is {:g}, but the beads in the frames are {} px wide, and sigma is the bead diameter; "
                  "correct the scale, or state the diameter of the beads (--diameter).",
                  scale, sizes));
}

}  // namespace twincell::imaging
