#include "imaging/settings/size_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/cancellation.hpp"
#include "imaging/find/vote_finder.hpp"
#include "imaging/settings/find_contrast.hpp"

namespace twincell::imaging {

namespace {

/// Radii (px) at which the sharpness of the votes has a maximum, sharpest first.
std::vector<double> sharp_radii(const cv::Mat1f& darkness, double smallest, double largest) {
  constexpr double kRatio = 1.03;
  constexpr std::size_t kMaxRadii = 3;
  constexpr double kMinSharpness = 0.1;  // smallest sharpness, as a fraction of the largest
  std::vector<double> sharpness;
  const int steps = static_cast<int>(std::log(largest / smallest) / std::log(kRatio));
  for (int k = 0; k <= steps; ++k) {
    throw_if_cancelled();
    sharpness.push_back(vote_sharpness(darkness, smallest * std::pow(kRatio, k)));
  }
  std::vector<std::pair<double, double>> tops;
  // A rise that continues to the last radius is no maximum.
  for (std::size_t k = 0; k + 1 < sharpness.size(); ++k) {
    const double before = k > 0 ? sharpness[k - 1] : 0, here = sharpness[k], after = sharpness[k + 1];
    if (here <= 0 || here < before || here <= after) continue;
    // A maximum at the smallest radius may be texture. It counts only if no other radius is sharper.
    if (k == 0 && here < *std::max_element(sharpness.begin(), sharpness.end())) continue;
    // The vertex of the parabola through this point and its neighbours.
    double at = static_cast<double>(k);
    const double curvature = before - 2 * here + after;
    if (k > 0 && curvature < 0) at += 0.5 * (before - after) / curvature;
    tops.emplace_back(here, smallest * std::pow(kRatio, at));
  }
  std::sort(tops.rbegin(), tops.rend());
  std::vector<double> radii;
  for (const auto& [sharp, radius] : tops)
    if (radii.size() < kMaxRadii && sharp > kMinSharpness * tops[0].first) radii.push_back(radius);
  return radii;
}

}  // namespace

double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options) {
  const double largest = std::min(kLargestRadius, 0.5 * std::min(grey.cols, grey.rows));
  if (largest < kSmallestRadius) return 0;
  const std::vector<double> radii =
      sharp_radii(prepare(grey, options, largest).darkness, kSmallestRadius, largest);
  return radii.empty() ? 0 : 2 * radii[0];
}

std::vector<Hypothesis> size_hypotheses(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                                        const std::optional<Contrasts>& of) {
  constexpr double kNoisy = 0.04, kSmooth = 1;  // darkness; px
  std::vector<Hypothesis> all;
  const double largest = std::min(kLargestRadius, 0.5 * std::min(grey.cols, grey.rows));
  for (const bool bright : {false, true}) {
    if (given.polarity_known && bright != given.preprocess.bright) continue;
    if (largest < kSmallestRadius && given.diameter_px <= 0) continue;
    PreprocessOptions options = given.preprocess;
    options.bright = bright;
    cv::Mat1f darkness =
        prepare(grey, options, given.diameter_px > 0 ? given.diameter_px / 2 : largest).darkness;
    const double contrast = of ? contrast_of(darkness) : 1;
    if (of && (contrast < of->least || contrast >= of->below)) continue;
    if (given.diameter_px > 0) {
      all.push_back({bright, given.diameter_px, contrast});
      continue;
    }
    darkness /= contrast;
    // Without smoothing the gradients of the noise would vote, with the sharpest peak at the smallest radius.
    const Noise noise = noise_of(darkness);
    if (noise.dark + noise.light > kNoisy * kNoisy)
      cv::GaussianBlur(darkness.clone(), darkness, {0, 0}, kSmooth);
    for (const double radius : sharp_radii(darkness, kSmallestRadius, largest))
      all.push_back({bright, 2 * radius, contrast});
    if (lattice > 0) all.push_back({bright, lattice, contrast});
  }
  return all;
}

}  // namespace twincell::imaging
