#pragma once
/// \file
/// Light, noise and discs of a rendered picture, pixel by pixel (picture.hpp).

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

#include "imaging/benchmark/backlit_discs.hpp"
#include "imaging/benchmark/blurred_disc.hpp"

namespace twincell::imaging::rendered {

/// A node of a quadrature on (-1/2, 1/2).
struct Node {
  double at, weight;
};
/// Gauss-Legendre nodes on (-1/2, 1/2).
inline constexpr std::array<Node, 3> kPixel{
    {{-0.387298334620741689, 5.0 / 18}, {0, 8.0 / 18}, {0.387298334620741689, 5.0 / 18}}};

/// The same nodes on segments of the path, each at most one pixel long.
inline std::vector<Node> path_nodes(const Disc& d) {
  if (d.path_x == 0 && d.path_y == 0) return {{0, 1}};
  const int pieces = std::max(1, cvCeil(std::hypot(d.path_x, d.path_y)));
  std::vector<Node> nodes;
  for (int i = 0; i < pieces; ++i)
    for (const Node& k : kPixel) nodes.push_back({(i + 0.5 + k.at) / pieces - 0.5, k.weight / pieces});
  return nodes;
}

/// Level of the back-light above the pedestal at (x, y), grey levels.
inline double light_at(const Picture& p, double x, double y) {
  if (p.uneven == 0) return p.light;
  const double u = 2 * x / p.width - 1, v = 2 * y / p.height - 1;
  return p.light *
         (1 - 0.5 * p.uneven * (u * u + v * v) + 0.1 * p.uneven * std::sin(5 * u + 2) * std::sin(7 * v));
}

using Vec4 = Eigen::Vector4d;

/// A disc's profile on the rectangle of pixels that it darkens.
class Stamp {
 public:
  Stamp(const Picture& picture, const Disc& disc, const BlurredDisc& profile)
      : disc_(disc), profile_(profile), nodes_(path_nodes(disc)) {
    const double reach_x = disc.radius + profile.rim() + 1 + 0.5 * std::abs(disc.path_x),
                 reach_y = disc.radius + profile.rim() + 1 + 0.5 * std::abs(disc.path_y);
    const cv::Point from(std::max(0, cvFloor(disc.x - reach_x)), std::max(0, cvFloor(disc.y - reach_y)));
    const cv::Point to(std::min(picture.width, cvCeil(disc.x + reach_x) + 1),
                       std::min(picture.height, cvCeil(disc.y + reach_y) + 1));
    if (to.x > from.x && to.y > from.y) window_ = {from, to};
  }
  /// The rectangle; empty for a disc outside the picture.
  [[nodiscard]] const cv::Rect& window() const { return window_; }

  /// Mean of f(dx, dy, r) over the pixel and the path.
  template <class F>
  [[nodiscard]] auto mean(int x, int y, F&& f) const {
    auto sum = f(0.0, 0.0, 1e9);
    for (const Node& t : nodes_)
      for (const Node& j : kPixel)
        for (const Node& i : kPixel) {
          const double dx = x + i.at - disc_.x - t.at * disc_.path_x,
                       dy = y + j.at - disc_.y - t.at * disc_.path_y;
          sum += t.weight * j.weight * i.weight * f(dx, dy, std::hypot(dx, dy));
        }
    return sum;
  }
  /// P of the pixel.
  [[nodiscard]] double covered(int x, int y) const {
    return mean(x, y, [&](double, double, double r) { return profile_.value(r); });
  }
  /// d(a P)/d(x, y, R, a)
  [[nodiscard]] Vec4 gradient(int x, int y) const {
    return mean(x, y, [&](double dx, double dy, double r) -> Vec4 {
      const double slope = disc_.contrast * profile_.by_distance(r) / std::max(r, 1e-9);
      return {-slope * dx, -slope * dy, disc_.contrast * profile_.by_radius(r), profile_.value(r)};
    });
  }
  /// The bright spot, share of the light.
  [[nodiscard]] double glare(int x, int y) const {
    if (disc_.glare == 0) return 0;
    const double s2 = disc_.glare_size * disc_.glare_size;
    return mean(x, y, [&](double dx, double dy, double r) {
      if (r > disc_.radius + profile_.rim()) return 0.0;
      const double gx = dx - disc_.glare_x, gy = dy - disc_.glare_y;
      return disc_.glare * std::exp(-0.5 * (gx * gx + gy * gy) / s2);
    });
  }

 private:
  const Disc& disc_;
  const BlurredDisc& profile_;
  std::vector<Node> nodes_;
  cv::Rect window_;
};

/// Stores one profile per radius.
class Profiles {
 public:
  explicit Profiles(double blur) : blur_(blur) {}
  const BlurredDisc& of(double radius) { return profiles_.try_emplace(radius, radius, blur_).first->second; }

 private:
  double blur_;
  std::map<double, BlurredDisc> profiles_;
};

/// Variance of the noise of a grey level, grey levels^2.
/// \param light level of the back-light there
inline double variance(double level, double light, const Picture& p, double snr) {
  const double sigma = p.light / snr;
  return sigma * sigma * (kReadShare + (1 - kReadShare) * std::max(0.0, level - p.pedestal) / light);
}

}  // namespace twincell::imaging::rendered
