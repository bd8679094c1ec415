#include "imaging/refine/light_correction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "imaging/preprocess/residual_illumination.hpp"

namespace twincell::imaging {

namespace {

/// Calls use(x, y, light, left, weight) for about `samples` pixels in the gaps between the discs: the
/// fraction of the light that the model leaves to the pixel, and its residual. A rim that is not yet in place
/// also leaves a residual. When it counted as light, it displaced touching beads by 0.004 px; pixels are
/// therefore weighted by the sixteenth power of the light.
template <class Use>
void over_gaps(const FrameModel& frame, double samples, Use&& use) {
  constexpr double kInDisc = 0.7;  // darkness of the model
  const cv::Size size = frame.size;
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(size.area()) / samples)));
  const double far = frame.ring_args().huber;
  for (int y = 0; y < size.height; y += stride)
    for (int x = y / stride % 2; x < size.width; x += stride) {
      const double t = static_cast<double>(frame.model(y, x)),
                   left = static_cast<double>(frame.picture(y, x)) - t;
      if (t > kInDisc || std::abs(left) > far) continue;
      const double light = std::max(0.0, 1 - t), light4 = light * light * light * light;
      use(x, y, light, left, light4 * light4 * light4 * light4);
    }
}

/// Quadratic surface through the residual in the gaps; absent if too few pixels are in gaps.
std::optional<Surface> quadratic_left(const FrameModel& frame) {
  constexpr double kSamples = 10000;
  constexpr int kMinPixels = 200;
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  Surface right = Surface::Zero();
  int n = 0;
  double weights = 0;
  over_gaps(frame, kSamples, [&](int x, int y, double light, double left, double weight) {
    const Surface f = light * surface_basis(x, y, frame.size);
    a += weight * f * f.transpose();
    right += weight * left * f;
    weights += weight;
    ++n;
  });
  if (n < kMinPixels) return std::nullopt;
  a.diagonal().tail<5>().array() += 1e-3 * weights;
  return a.ldlt().solve(right);
}

/// Divides the light of the picture by 1 - q - ripple.
/// \param ripple correction in addition to the quadratic surface, for each pixel; empty: no ripple
void divide_light(FrameModel& frame, const Surface& q, const cv::Mat1f& ripple) {
  const cv::Size size = frame.size;
  cv::Mat1f to = frame.picture;
  if (!frame.owns_picture()) {
    to = cv::Mat1f(frame.picture.size());
    to.colRange(size.width, to.cols).setTo(kUnseen);
  }
  std::vector<float> levelled(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    const float* from = frame.picture[y];
    float *d = to[y], *light = levelled.data();
    const SurfaceRow row = surface_row(q, y, size);
    // Separate loops: the compiler does not vectorise a division and a selection in one loop.
    for (int x = 0; x < size.width; ++x) light[x] = 1 - row.at(x);
    if (!ripple.empty())
      for (int x = 0; x < size.width; ++x) light[x] -= ripple(y, x);
    for (int x = 0; x < size.width; ++x) light[x] = 1 - (1 - from[x]) / light[x];
    for (int x = 0; x < size.width; ++x) d[x] = from[x] < kUnseen ? light[x] : kUnseen;
  }
  frame.take_picture(to);
}

/// Residual light after a quadratic surface, tile by tile. One extra row of tiles on each side carries no
/// data: the border of the frame is between them and their neighbours.
struct Tiles {
  cv::Mat1d mean, variance;
};

Tiles tiles_beside(const FrameModel& frame, const Surface& q, int side, double samples) {
  const cv::Size count(frame.size.width / side + 3, frame.size.height / side + 3);
  cv::Mat1d sum = cv::Mat1d::zeros(count), weights = sum.clone(), squares = sum.clone();
  over_gaps(frame, samples, [&](int x, int y, double light, double left, double weight) {
    const int at_x = x / side + 1, at_y = y / side + 1;
    sum(at_y, at_x) += weight * light * (left - light * q.dot(surface_basis(x, y, frame.size)));
    weights(at_y, at_x) += weight * light * light;
    squares(at_y, at_x) += weight * weight * light * light;
  });
  const double variance = frame.noise.dark + frame.noise.light;
  Tiles tiles{cv::Mat1d::zeros(count), cv::Mat1d(count, HUGE_VAL)};
  for (int y = 0; y < count.height; ++y)
    for (int x = 0; x < count.width; ++x)
      if (const double w = weights(y, x); w > 0) {
        tiles.mean(y, x) = sum(y, x) / w;
        tiles.variance(y, x) = variance * squares(y, x) / (w * w);
      }
  return tiles;
}

/// Ripple of the light after a quadratic surface, pixel by pixel; empty if no ripple is detected.
cv::Mat1f ripple_beside(const FrameModel& frame, const Surface& q) {
  constexpr double kSamplesToDetect = 10000, kSamplesToMeasure = 400000;
  constexpr int kMaxTiles = 32;  // along the longer side
  const cv::Size size = frame.size;
  const int side =
      std::max(cvCeil(6 * frame.priors.largest()), std::max(size.width, size.height) / kMaxTiles);
  if (const Tiles seen = tiles_beside(frame, q, side, kSamplesToDetect);
      !has_ripple(seen.mean, seen.variance))
    return {};
  const Tiles found = tiles_beside(frame, q, side, kSamplesToMeasure);
  const cv::Mat1f map = smooth_ripple(found.mean, found.variance);
  cv::Mat1f wide;
  cv::resize(map, wide, map.size() * side, 0, 0, cv::INTER_CUBIC);
  return wide(cv::Rect({side, side}, size));
}

}  // namespace

bool level(FrameModel& frame) {
  constexpr double kOfNoise = 0.02;  // a smaller correction displaces no bead
  if (frame.stale) frame.render();
  const std::optional<Surface> q = quadratic_left(frame);
  if (!q || !(q->cwiseAbs().sum() >= kOfNoise * std::sqrt(frame.noise.dark + frame.noise.light)))
    return false;
  divide_light(frame, *q, {});
  return true;
}

bool level_ripple(FrameModel& frame) {
  const std::optional<Surface> q = quadratic_left(frame);
  if (!q) return false;
  const cv::Mat1f ripple = ripple_beside(frame, *q);
  if (ripple.empty()) return false;
  divide_light(frame, *q, ripple);
  return true;
}

}  // namespace twincell::imaging
