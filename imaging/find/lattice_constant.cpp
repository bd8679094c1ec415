#include "imaging/find/lattice_constant.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace twincell::imaging {

namespace {

/// Clips levels farther than 1.5 interquartile ranges from the quartiles: few vacancies would hide the weak
/// modulation of a crystal of small beads.
void clip_outliers(cv::Mat1f& levels) {
  constexpr float kFence = 1.5;
  std::vector<float> sorted(levels.begin(), levels.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t quarter = sorted.size() / 4;
  const float low = sorted[quarter], high = sorted[sorted.size() - 1 - quarter],
              fence = kFence * (high - low);
  cv::min(levels, high + fence, levels);
  cv::max(levels, low - fence, levels);
}

}  // namespace

double lattice_constant(const cv::Mat& grey) {
  constexpr double kBroad = 10;       // px; broader structures are removed
  constexpr double kStandsOut = 0.2;  // least prominence, of the drop to the first minimum
  constexpr double kRing = 0.12;      // relative half width of the ring that is searched for the peak
  constexpr double kNearly = 0.6;     // of the largest prominence; gaps are less prominent than discs
  constexpr double kSmallest = 5.5, kLargest = 4 * kBroad;  // px
  const double largest = std::min(kLargest, static_cast<double>(std::min(grey.cols, grey.rows)));
  if (largest < 2 * kSmallest) return 0;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  cv::Mat1f broad;
  cv::GaussianBlur(levels, broad, {0, 0}, kBroad);
  levels -= broad;
  clip_outliers(levels);
  // Autocorrelation: by Fourier transform, with padding. The same for a picture of ones counts the pairs.
  const auto reach = static_cast<int>(std::ceil(1.5 * largest));
  const cv::Size size(cv::getOptimalDFTSize(levels.cols + reach), cv::getOptimalDFTSize(levels.rows + reach));
  const auto correlated = [&](const cv::Mat1f& picture) {
    cv::Mat1f padded = cv::Mat1f::zeros(size);
    picture.copyTo(padded(cv::Rect({0, 0}, picture.size())));
    cv::Mat2f waves;
    cv::dft(padded, waves, cv::DFT_COMPLEX_OUTPUT);
    cv::mulSpectrums(waves, waves, waves, 0, true);
    cv::Mat1f out;
    cv::dft(waves, out, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
    return out;
  };
  const cv::Mat1f products = correlated(levels), pairs = correlated(cv::Mat1f::ones(levels.size()));
  const auto each = [&](auto&& use) {  // half of the plane; the other half is equal by symmetry
    for (int y = -reach; y <= reach; ++y)
      for (int x = 0; x <= reach; ++x) {
        if (x >= levels.cols || std::abs(y) >= levels.rows) continue;
        const cv::Point at(x, y < 0 ? y + size.height : y);
        use(std::hypot(x, y), static_cast<double>(products(at)), static_cast<double>(pairs(at)));
      }
  };
  // Average over directions, by distance in whole pixels.
  std::vector<double> sum(static_cast<std::size_t>(reach) + 1), count(sum.size());
  each([&](double distance, double product, double pair) {
    const auto r = static_cast<std::size_t>(std::lround(distance));
    if (r < sum.size()) sum[r] += product, count[r] += pair;
  });
  std::vector<double> mean;
  for (std::size_t r = 0; r < sum.size(); ++r) mean.push_back(sum[r] / std::max(count[r], 1.0));
  std::vector<std::pair<double, double>> tops;  // distance and prominence of each maximum
  std::size_t low = 0, first = 0;               // last minimum, and first minimum of all
  for (std::size_t r = 1; r + 1 < mean.size() && static_cast<double>(r) <= largest; ++r) {
    if (mean[r] < mean[r - 1] && mean[r] <= mean[r + 1]) low = r, first = first > 0 ? first : r;
    if (low == 0 || mean[r] < mean[r - 1] || mean[r] <= mean[r + 1] || static_cast<double>(r) < kSmallest)
      continue;
    std::size_t next = r + 1;
    while (next + 1 < mean.size() && mean[next + 1] < mean[next]) ++next;
    tops.emplace_back(static_cast<double>(r), mean[r] - 0.5 * (mean[low] + mean[next]));
  }
  double most = 0;
  for (const auto& [at, stands_out] : tops) most = std::max(most, stands_out);
  if (tops.empty() || most < kStandsOut * (mean[0] - mean[first])) return 0;
  const double about = std::find_if(tops.begin(), tops.end(), [&](const auto& top) {
                         return top.second >= kNearly * most;
                       })->first;
  // The maximum of the average over directions is broad; the single peaks of the autocorrelation are sharp.
  double highest = 0, constant = about;
  each([&](double distance, double product, double pair) {
    if (std::abs(distance / about - 1) > kRing || product <= highest * pair) return;
    highest = product / pair;
    constant = distance;
  });
  return constant;
}

}  // namespace twincell::imaging
