#include "imaging/settings/patterned_discs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/cancellation.hpp"
#include "core/median.hpp"
#include "imaging/find/vote_finder.hpp"
#include "imaging/refine/edge_fit.hpp"
#include "imaging/settings/find_contrast.hpp"

namespace twincell::imaging {

std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given) {
  constexpr double kMinDiameter_px = 80, kMaxDiameter_px = 400, kRatio = 1.04;  // px
  constexpr double kShrink = 4;
  constexpr double kApart = 1.15,
                   kComparable = 0.7;  // second size: least ratio to the first; relative sharpness
  constexpr double kCovered = 0.2;     // fraction of the frame that the discs must cover
  constexpr double kNoise = 0.035;     // largest noise, relative to a disc's contrast, that creates no edges
  constexpr double kMinVisibleShare = 0.7;  // mean fraction of the rims that must be visible
  constexpr std::ptrdiff_t kMinDiscs = 3;
  const double largest = std::min(kMaxDiameter_px, 0.5 * std::min(grey.cols, grey.rows));
  std::optional<FoundSettings> best;
  for (const bool bright : {false, true}) {
    if (largest < kMinDiameter_px || (given.polarity_known && bright != given.preprocess.bright)) continue;
    LocatorOptions options = given;
    // Sizes: the sharpest votes on the reduced picture.
    options.refine.method = kEdgeRefiner.word;
    options.preprocess.bright = bright;
    options.diameter_px = kMinDiameter_px;
    options.preprocess.contrast = find_contrast(grey, options);
    const Prepared image = prepare(grey, options.preprocess, largest / 2);
    const Noise noise = noise_of(image.darkness);
    if (noise.dark + noise.light > kNoise * kNoise) continue;
    cv::Mat1f small;
    cv::resize(image.darkness, small, {}, 1 / kShrink, 1 / kShrink, cv::INTER_AREA);
    std::vector<std::pair<double, double>> tops;  // sharpness, diameter
    double before = 0, last = 0;
    for (double d = kMinDiameter_px; d <= largest; d *= kRatio) {
      throw_if_cancelled();
      const double now = vote_sharpness(small, 0.5 * d / kShrink);
      if (last > before && last >= now) tops.emplace_back(last, d / kRatio);
      before = std::exchange(last, now);
    }
    if (tops.empty()) continue;
    std::sort(tops.rbegin(), tops.rend());
    options.diameter_px = tops[0].second;
    for (const auto& [sharp, d] : tops)
      if (options.other_diameters_px.empty() && sharp > kComparable * tops[0].first &&
          std::max(d / tops[0].second, tops[0].second / d) > kApart)
        options.other_diameters_px = {d};
    std::vector<Detection> beads = locate(grey, options).beads;
    // Refinement: each size becomes the median of its discs; a size with fewer than kMinDiscs discs is
    // dropped.
    const auto settle = [&](double d) {
      std::vector<double> radii;
      for (const Detection& b : beads)
        if (std::abs(2 * b.radius / d - 1) < kApart - 1) radii.push_back(b.radius);
      return std::ssize(radii) < kMinDiscs ? 0.0 : 2 * upper_median(std::move(radii));
    };
    const double first = settle(options.diameter_px);
    if (first == 0) continue;
    options.diameter_px = first;
    if (!options.other_diameters_px.empty()) {
      const double second = settle(options.other_diameters_px[0]);
      options.other_diameters_px.clear();
      if (second > 0) options.other_diameters_px.push_back(second);
    }
    // Acceptance: the discs must cover enough of the frame and show enough of their rims.
    beads = locate(grey, options).beads;
    double covered = 0, explained = 0, rims = 0;
    for (const Detection& b : beads) {
      rims += b.score;
      covered += std::numbers::pi * b.radius * b.radius;
      explained -= b.radius * b.radius * std::log(std::max(1 - b.score, 1e-6));
    }
    if (covered < kCovered * grey.cols * grey.rows || std::ssize(beads) < kMinDiscs ||
        rims < kMinVisibleShare * static_cast<double>(beads.size()))
      continue;
    if (!best || explained > best->explained)
      best = FoundSettings{options.diameter_px, bright, explained, options.other_diameters_px,
                           std::string(kEdgeRefiner.word)};
  }
  return best;
}

}  // namespace twincell::imaging
