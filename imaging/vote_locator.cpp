#include "imaging/vote_locator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace twincell {

namespace {

constexpr double kSmoothing_px = 1.5;
constexpr float kMinGradient = 0.05f;  // darkness per pixel; noise at SNR 18 gives 0.02

// d smoothed by 0.7 px before Scharr: the votes of a 15 px disc then scatter by less than a pixel.
void gradient(const cv::Mat1f& d, cv::Mat1f& gx, cv::Mat1f& gy) {
  cv::Mat1f smooth;
  cv::GaussianBlur(d, smooth, cv::Size(), 0.7, 0.7, cv::BORDER_REPLICATE);
  cv::Scharr(smooth, gx, CV_32F, 1, 0, 1.0 / 32, 0, cv::BORDER_REPLICATE);
  cv::Scharr(smooth, gy, CV_32F, 0, 1, 1.0 / 32, 0, cv::BORDER_REPLICATE);
}

// Votes, on a picture enlarged by `pad` on every side.
cv::Mat1f votes(const cv::Mat1f& d, const cv::Mat1b& ignore, double radius, int pad) {
  cv::Mat1f gx, gy;
  gradient(d, gx, gy);
  cv::Mat1f sum = cv::Mat1f::zeros(d.rows + 2 * pad, d.cols + 2 * pad);
  std::vector<float> strength(static_cast<std::size_t>(d.cols));
  for (int y = 0; y < d.rows; ++y) {
    const float *gx_row = gx[y], *gy_row = gy[y];
    for (int x = 0; x < d.cols; ++x)
      strength[static_cast<std::size_t>(x)] = gx_row[x] * gx_row[x] + gy_row[x] * gy_row[x];
    for (int x = 0; x < d.cols; ++x) {
      const float g2 = strength[static_cast<std::size_t>(x)];
      if (g2 < kMinGradient * kMinGradient || (!ignore.empty() && ignore(y, x) != 0)) continue;
      const float g = std::sqrt(g2), r = static_cast<float>(radius) / g;
      const float vx = static_cast<float>(x + pad) + r * gx_row[x],
                  vy = static_cast<float>(y + pad) + r * gy_row[x];
      const int ix = static_cast<int>(vx), iy = static_cast<int>(vy);  // positive within the border
      if (vx < 0 || vy < 0 || ix + 1 >= sum.cols || iy + 1 >= sum.rows) continue;
      const float fx = vx - static_cast<float>(ix), fy = vy - static_cast<float>(iy);
      float *upper = sum[iy] + ix, *lower = sum[iy + 1] + ix;
      upper[0] += g * (1 - fx) * (1 - fy);
      upper[1] += g * fx * (1 - fy);
      lower[0] += g * (1 - fx) * fy;
      lower[1] += g * fx * fy;
    }
  }
  cv::GaussianBlur(sum, sum, cv::Size(), kSmoothing_px, kSmoothing_px, cv::BORDER_CONSTANT);
  return sum;
}

// Offset of a parabola's top from its middle sample.
double parabola_top(float left, float middle, float right) {
  const float curvature = left - 2 * middle + right;
  return curvature < 0 ? static_cast<double>(std::clamp(0.5f * (left - right) / curvature, -0.5f, 0.5f))
                       : 0.0;
}

std::vector<Proposal> peaks(const cv::Mat1f& sum, int pad, double full_circle, double min_score) {
  std::vector<Proposal> found;
  const auto least = static_cast<float>(min_score * full_circle);
  for (int y = 1; y + 1 < sum.rows; ++y)
    for (int x = 1; x + 1 < sum.cols; ++x) {
      const float v = sum(y, x);
      if (v < least) continue;
      if (v <= sum(y - 1, x - 1) || v <= sum(y - 1, x) || v <= sum(y - 1, x + 1) || v <= sum(y, x - 1) ||
          v < sum(y, x + 1) || v < sum(y + 1, x - 1) || v < sum(y + 1, x) || v < sum(y + 1, x + 1))
        continue;
      found.push_back({x - pad + parabola_top(sum(y, x - 1), v, sum(y, x + 1)),
                       y - pad + parabola_top(sum(y - 1, x), v, sum(y + 1, x)),
                       static_cast<double>(v) / full_circle});
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
  return found;
}

std::vector<Proposal> suppress_near(const std::vector<Proposal>& sorted, double distance) {
  std::vector<Proposal> kept;
  for (const Proposal& p : sorted) {
    const bool near_better = std::any_of(kept.begin(), kept.end(), [&](const Proposal& q) {
      return std::abs(p.x - q.x) < distance && std::hypot(p.x - q.x, p.y - q.y) < distance;
    });
    if (!near_better) kept.push_back(p);
  }
  return kept;
}

}  // namespace

std::vector<Proposal> VoteFinder::find(const Prepared& image, const FindOptions& options) {
  const double r = options.radius_px;
  const int pad = static_cast<int>(std::ceil(r)) + 2;
  const cv::Mat1f sum = votes(image.darkness, image.opaque, r, pad);
  // 2 pi R pixels of edge, each of integral 1, meet in a spot of the smoothing plus about a pixel of scatter.
  const double full_circle =
      2 * std::numbers::pi * r / (2 * std::numbers::pi * (kSmoothing_px * kSmoothing_px + 1));
  return suppress_near(peaks(sum, pad, full_circle, options.min_score), 0.8 * 2 * r);
}

double vote_sharpness(const cv::Mat1f& darkness, double radius_px) {
  const int pad = static_cast<int>(std::ceil(radius_px)) + 2;
  const cv::Mat1f sum = votes(darkness, {}, radius_px, pad);
  const double total = cv::sum(sum)[0];
  return total > 0 ? sum.dot(sum) / total : 0.0;
}

}  // namespace twincell
