#include "imaging/preprocess/preprocess.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "imaging/disc/ring_normal_equations.hpp"
#include "imaging/preprocess/wall_regions.hpp"

namespace twincell::imaging {

namespace {

/// Rows of a frame as floats, inverted if necessary, so that beads are dark on a light background.
class Rows {
 public:
  Rows(const cv::Mat& grey, bool bright) : grey_(grey), bright_(bright) {
    double top = 0;
    if (bright) cv::minMaxLoc(grey, nullptr, &top);
    top_ = static_cast<float>(top);
  }
  [[nodiscard]] cv::Size size() const { return grey_.size(); }
  void read(int y, float* to) const {
    if (grey_.depth() == CV_8U)
      copy(grey_.ptr<std::uint8_t>(y), to);
    else if (grey_.depth() == CV_16U)
      copy(grey_.ptr<std::uint16_t>(y), to);
    else
      copy(grey_.ptr<float>(y), to);
    if (!bright_) return;
    for (int x = 0; x < grey_.cols; ++x) to[x] = top_ - to[x];
  }

 private:
  template <class T>
  void copy(const T* from, float* to) const {
    for (int x = 0; x < grey_.cols; ++x) to[x] = static_cast<float>(from[x]);
    if constexpr (std::is_floating_point_v<T>)
      for (int x = 0; x < grey_.cols; ++x) to[x] = std::isnan(to[x]) ? 0.0F : to[x];
  }
  const cv::Mat& grey_;
  bool bright_;
  float top_ = 0;
};

// The light is visible only through the gaps. Starting from a bright quantile, a quadratic surface is fitted
// repeatedly to the pixels close to it or brighter. Pixels above the surface count three times as much as
// pixels below it, which are often at the edges of gaps.
Surface bright_envelope(const Rows& image) {
  constexpr double kSamples = 5000;
  const cv::Size size = image.size();
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(size.area()) / kSamples)));
  const auto columns = static_cast<std::size_t>((size.width + stride - 1) / stride);
  std::vector<float> values;
  std::vector<float> row(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; y += stride) {
    image.read(y, row.data());
    for (int x = 0; x < size.width; x += stride) values.push_back(row[static_cast<std::size_t>(x)]);
  }
  std::vector<double> across;
  for (int x = 0; x < size.width; x += stride) across.push_back(surface_basis(x, 0, size)[1]);
  Surface c = Surface::Zero();
  constexpr double kBright = 0.99;
  std::vector<float> ordered = values;
  const auto at = static_cast<std::ptrdiff_t>(kBright * static_cast<double>(values.size() - 1));
  std::nth_element(ordered.begin(), ordered.begin() + at, ordered.end());
  c[0] = static_cast<double>(ordered[static_cast<std::size_t>(at)]);
  for (const double near : {0.7, 0.8, 0.85, 0.9, 0.9, 0.9}) {
    // Normal equations: sums of w u^p v^q, p + q <= 4, and of w value u^p v^q, p + q <= 2. The sums over u
    // are made row by row.
    std::array<std::array<double, 5>, 5> moment{};
    std::array<std::array<double, 3>, 3> of_value{};
    int used = 0;
    for (std::size_t first = 0; first < values.size(); first += columns) {
      const double v = surface_basis(0, static_cast<int>(first / columns) * stride, size)[2];
      const double flat = c[0] + c[2] * v + c[5] * v * v, slope = c[1] + c[4] * v, curve = c[3];
      std::array<double, 5> sums{};
      std::array<double, 3> value_sums{};
      for (std::size_t k = 0; k < columns; ++k) {
        const auto value = static_cast<double>(values[first + k]);
        const double u = across[k], level = flat + u * (slope + u * curve);
        const double w = value < near * level ? 0.0 : value > level ? 3.0 : 1.0;
        const double wu = w * u, wuu = wu * u;
        used += w > 0 ? 1 : 0;
        sums[0] += w, sums[1] += wu, sums[2] += wuu, sums[3] += wuu * u, sums[4] += wuu * u * u;
        value_sums[0] += w * value, value_sums[1] += wu * value, value_sums[2] += wuu * value;
      }
      double power = 1;
      for (std::size_t q = 0; q < 5; ++q, power *= v) {
        for (std::size_t p = 0; p + q < 5; ++p) moment[p][q] += power * sums[p];
        for (std::size_t p = 0; p + q < 3; ++p) of_value[p][q] += power * value_sums[p];
      }
    }
    if (used < 60) break;  // too few bright pixels to fit a slope: the level is kept
    constexpr std::array<std::array<std::size_t, 2>, 6> kPowers = {
        {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}}};  // as in surface_basis
    Eigen::Matrix<double, 6, 6> a;
    Surface rhs;
    for (std::size_t m = 0; m < kPowers.size(); ++m) {
      const auto [p, q] = kPowers[m];
      rhs[static_cast<Eigen::Index>(m)] = of_value[p][q];
      for (std::size_t n = 0; n < kPowers.size(); ++n)
        a(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(n)) =
            moment[p + kPowers[n][0]][q + kPowers[n][1]];
    }
    a.diagonal().tail<5>().array() += 1e-3 * used;
    c = a.ldlt().solve(rhs);
  }
  return c;
}

}  // namespace

Prepared prepare(const cv::Mat& grey, const PreprocessOptions& options, double radius_px) {
  const Rows image(grey, options.bright);
  const cv::Size size = image.size();
  Prepared p;
  p.unit = options.contrast;
  p.light = bright_envelope(image);
  cv::Mat1f with_spare(size.height, size.width + kSpareColumns);
  with_spare.colRange(size.width, with_spare.cols).setTo(kUnseen);
  p.darkness = with_spare.colRange(0, size.width);
  constexpr float kMinLight = 1e-20F;
  const auto gain = static_cast<float>(1 / options.contrast);
  std::vector<float> grey_levels(static_cast<std::size_t>(size.width));
  for (int y = 0; y < size.height; ++y) {
    const SurfaceRow light = surface_row(p.light, y, size);
    image.read(y, grey_levels.data());
    const float* i = grey_levels.data();
    float* d = p.darkness[y];
    for (int x = 0; x < size.width; ++x) {
      const float bright = light.at(x), dark = (1 - i[x] / std::max(bright, kMinLight)) * gain;
      const float above = dark > -1 ? dark : -1.0F, bounded = above > 2 ? 2.0F : above;
      d[x] = bright > 0 ? bounded : 0.0F;
    }
  }
  // A dark region that contains a disc of this many bead radii is a wall.
  constexpr double kOpaqueRadii = 2.5;
  p.opaque = wall_regions(p, options.bright, radius_px, kOpaqueRadii);
  return p;
}

}  // namespace twincell::imaging
