#include "imaging/preprocess.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace twincell {

namespace {

using Surface = Eigen::Matrix<double, 6, 1>;

Surface basis(double u, double v) {
  Surface b;
  b << 1, u, v, u * u, u * v, v * v;
  return b;
}

double scaled(int i, int n) {
  return n > 1 ? 2.0 * i / (n - 1) - 1.0 : 0.0;
}

float quantile(std::vector<float> values, double q) {
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// The light is seen only through the gaps. Starting from a bright quantile, a quadratic is fitted again and
// again to the pixels that come near it; pixels above count three times as much as those below, which are
// often gap edges.
cv::Mat1f bright_envelope(const cv::Mat1f& image) {
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(image.total()) / 20000.0)));
  std::vector<float> sample;
  for (int y = 0; y < image.rows; y += stride)
    for (int x = 0; x < image.cols; x += stride) sample.push_back(image(y, x));
  Surface c = Surface::Zero();
  c[0] = static_cast<double>(quantile(sample, 0.99));
  for (const double near : {0.7, 0.8, 0.85, 0.9, 0.9, 0.9}) {
    Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
    Surface rhs = Surface::Zero();
    int used = 0;
    for (int y = 0; y < image.rows; y += stride)
      for (int x = 0; x < image.cols; x += stride) {
        const Surface b = basis(scaled(x, image.cols), scaled(y, image.rows));
        const double value = static_cast<double>(image(y, x)), level = c.dot(b);
        if (value < near * level) continue;
        const double w = value > level ? 3 : 1;
        a += w * b * b.transpose();
        rhs += w * value * b;
        ++used;
      }
    if (used < 60) break;  // too little light to see a slope: the level stands
    a.diagonal().tail<5>().array() += 1e-3 * used;
    c = a.ldlt().solve(rhs);
  }
  cv::Mat1f surface(image.size());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      surface(y, x) = static_cast<float>(c.dot(basis(scaled(x, image.cols), scaled(y, image.rows))));
  return surface;
}

// Morphological opening of the dark region by a disc, through two exact distance maps. The frame is continued
// beyond its border, so that a thin strip of plate at the bottom of a frame is as thick as the plate is.
cv::Mat1b large_dark_regions(const cv::Mat1f& darkness, double disc_radius_px) {
  const int pad = cvCeil(2 * disc_radius_px);
  cv::Mat1b dark = darkness > 0.75f;
  cv::copyMakeBorder(dark, dark, pad, pad, pad, pad, cv::BORDER_REPLICATE);
  if (cv::countNonZero(dark) == static_cast<int>(dark.total())) return cv::Mat1b::zeros(darkness.size());
  cv::Mat1f inside;
  cv::distanceTransform(dark, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const cv::Mat1b core = inside > disc_radius_px;
  if (cv::countNonZero(core) == 0) return cv::Mat1b::zeros(darkness.size());
  cv::Mat1f to_core;
  cv::distanceTransform(~core, to_core, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const cv::Mat1b regions = to_core < disc_radius_px;
  return regions(cv::Rect(pad, pad, darkness.cols, darkness.rows)).clone();
}

}  // namespace

Prepared prepare(const cv::Mat& grey, const PreprocessOptions& options, double radius_px) {
  cv::Mat1f image;
  grey.convertTo(image, CV_32F);
  cv::patchNaNs(image, 0);
  if (options.bright) {
    double top = 0;
    cv::minMaxLoc(image, nullptr, &top);
    image = top - image;
  }
  Prepared p;
  p.background = bright_envelope(image);
  p.darkness.create(image.size());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const float b = p.background(y, x);
      p.darkness(y, x) = b > 0 ? std::clamp(1 - image(y, x) / b, -1.0f, 2.0f) : 0.0f;
    }
  p.opaque = large_dark_regions(p.darkness, options.opaque_radii * radius_px);
  return p;
}

}  // namespace twincell
