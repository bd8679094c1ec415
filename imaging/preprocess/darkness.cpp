#include "imaging/preprocess/darkness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/quantile.hpp"

namespace twincell::imaging {

namespace {

/// -1 to 1 over n pixels.
double scaled(double i, int n) {
  return n > 1 ? 2.0 * i / (n - 1) - 1.0 : 0.0;
}

}  // namespace

double contrast_of(const cv::Mat1f& darkness) {
  constexpr double kSamples = 40000, kLow = -0.5, kHigh = 1.5;
  constexpr std::size_t kBins = 200;
  constexpr double kMaxScaledDarkness = 0.6;  // darker discs need no scaling
  constexpr double kMinDifference = 6;        // of the two classes, standard deviations of the noise
  const int stride =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(darkness.total()) / kSamples)));
  std::array<double, kBins> share{};
  double n = 0, sum = 0;
  const auto value = [&](std::size_t bin) {
    return kLow + (kHigh - kLow) * (static_cast<double>(bin) + 0.5) / static_cast<double>(kBins);
  };
  for (int y = stride / 2; y < darkness.rows; y += stride)
    for (int x = stride / 2; x < darkness.cols; x += stride) {
      const double d = std::clamp(static_cast<double>(darkness(y, x)), kLow, kHigh);
      const auto bin = static_cast<std::size_t>((d - kLow) / (kHigh - kLow) * static_cast<double>(kBins));
      share[std::min(bin, kBins - 1)] += 1;
    }
  for (std::size_t b = 0; b < kBins; ++b) n += share[b], sum += share[b] * value(b);
  double below = 0, sum_below = 0, best = 0, dark = 0, light = 0;
  for (std::size_t b = 0; b + 1 < kBins; ++b) {
    below += share[b];
    sum_below += share[b] * value(b);
    if (below == 0 || below == n) continue;
    const double low = sum_below / below, high = (sum - sum_below) / (n - below);
    const double between = below * (n - below) * (high - low) * (high - low);
    if (between > best) best = between, light = low, dark = high;
  }
  if (best == 0 || dark > kMaxScaledDarkness) return 1;
  const Noise noise = noise_of(darkness);
  return dark - light > kMinDifference * std::sqrt(noise.dark + noise.light) ? std::max(dark, 0.02) : 1;
}

Noise noise_of(const cv::Mat1f& darkness) {
  constexpr float kMaxLight = 0.15F, kMinDark = 0.85F;  // darkness of light and of dark pixels
  constexpr std::size_t kMinPixels = 50;                // of a class
  constexpr double kSamples = 20000;                    // pixels
  constexpr double kMinVariance = 1e-6;
  constexpr double kMinDarkVariance = 0.1;  // fraction of the variance of light pixels
  std::vector<float> light, dark;
  const int stride = std::max(1, static_cast<int>(static_cast<double>(darkness.total()) / kSamples));
  for (int y = stride / 2; y < darkness.rows; y += stride) {
    const float* d = darkness[y];
    for (int x = 1; x + 1 < darkness.cols; ++x) {
      const float low = std::min({d[x - 1], d[x], d[x + 1]}), high = std::max({d[x - 1], d[x], d[x + 1]});
      if (high < kMaxLight) light.push_back(std::abs(d[x - 1] - 2 * d[x] + d[x + 1]));
      if (low > kMinDark) dark.push_back(std::abs(d[x - 1] - 2 * d[x] + d[x + 1]));
    }
  }
  const auto variance = [&](std::vector<float>& v) {
    constexpr double kFromMedian =
        1 / (0.6745 * 0.6745 * 6);  // from the median of |second difference| to the noise
    const auto middle = static_cast<double>(lower_quantile(std::move(v), 0.5));
    return middle * middle * kFromMedian;
  };
  if (light.size() < kMinPixels) return {};
  const double lit = std::max(kMinVariance, variance(light));
  const double black = dark.size() < kMinPixels ? lit : variance(dark);
  Noise n;
  n.dark = std::max({kMinVariance, kMinDarkVariance * lit, black});
  n.light = std::max(0.0, lit - n.dark);
  return n;
}

SurfaceRow surface_row(const Surface& c, int y, cv::Size size) {
  const double v = surface_basis(0, y, size)[2];
  // u = step x + first
  const double first = surface_basis(0, y, size)[1], step = size.width > 1 ? 2.0 / (size.width - 1) : 0;
  const double flat = c[0] + c[2] * v + c[5] * v * v, slope = c[1] + c[4] * v, curve = c[3];
  return {static_cast<float>(flat + slope * first + curve * first * first),
          static_cast<float>(step * (slope + 2 * curve * first)), static_cast<float>(step * step * curve)};
}

Surface surface_basis(double x, double y, cv::Size size) {
  const double u = scaled(x, size.width), v = scaled(y, size.height);
  Surface b;
  b << 1, u, v, u * u, u * v, v * v;
  return b;
}

double blur_of(const cv::Mat1f& darkness) {
  constexpr float kMinSlope = 0.05F;                             // darkness per pixel
  constexpr double kSteepestShare = 0.01, kDarkestShare = 0.05;  // of the pixels
  constexpr double kMinBlur = 0.5, kMaxBlur = 5;                 // px
  constexpr double kKernelVariance = 0.5;  // px^2; approximate blur of an edge by the kernel itself
  constexpr double kSamples = 20000;       // number of pixels that are sampled
  const int stride = std::max(1, cvRound(std::sqrt(static_cast<double>(darkness.total()) / kSamples)));
  std::vector<float> steep, seen;
  for (int y = 1; y + 1 < darkness.rows; y += stride) {
    const float *above = darkness[y - 1], *row = darkness[y], *below = darkness[y + 1];
    for (int x = 1; x + 1 < darkness.cols; x += stride) {
      seen.push_back(row[x]);
      // Scharr's kernel; its weights give 32 times the slope per pixel.
      const float left = 3 * (above[x - 1] + below[x - 1]) + 10 * row[x - 1],
                  right = 3 * (above[x + 1] + below[x + 1]) + 10 * row[x + 1],
                  up = 3 * (above[x - 1] + above[x + 1]) + 10 * above[x],
                  down = 3 * (below[x - 1] + below[x + 1]) + 10 * below[x];
      const float across = (right - left) / 32, along = (down - up) / 32;
      if (const float g2 = across * across + along * along; g2 > kMinSlope * kMinSlope) steep.push_back(g2);
    }
  }
  if (steep.empty()) return kMinBlur;
  const auto highest = [](std::vector<float>& values, double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + at, values.end(), std::greater<>());
    return static_cast<double>(values[static_cast<std::size_t>(at)]);
  };
  const double dark = std::min(1.0, highest(seen, kDarkestShare));
  const double variance = dark * dark / (2 * std::numbers::pi * highest(steep, kSteepestShare));
  return std::clamp(std::sqrt(std::max(0.0, variance - kKernelVariance)), kMinBlur, kMaxBlur);
}

}  // namespace twincell::imaging
