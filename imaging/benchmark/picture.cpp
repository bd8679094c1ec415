#include "imaging/benchmark/picture.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>

#include "imaging/benchmark/blurred_disc.hpp"

namespace twincell::imaging::rendered {

namespace {

struct Node {
  double at, weight;
};
// Gauss-Legendre nodes on (-1/2, 1/2).
constexpr std::array<Node, 3> kPixel{
    {{-0.387298334620741689, 5.0 / 18}, {0, 8.0 / 18}, {0.387298334620741689, 5.0 / 18}}};

// The same nodes on segments of the path, each at most one pixel long.
std::vector<Node> path_nodes(const Disc& d) {
  if (d.path_x == 0 && d.path_y == 0) return {{0, 1}};
  const int pieces = std::max(1, cvCeil(std::hypot(d.path_x, d.path_y)));
  std::vector<Node> nodes;
  for (int i = 0; i < pieces; ++i)
    for (const Node& k : kPixel) nodes.push_back({(i + 0.5 + k.at) / pieces - 0.5, k.weight / pieces});
  return nodes;
}

double light_at(const Picture& p, double x, double y) {
  if (p.uneven == 0) return p.light;
  const double u = 2 * x / p.width - 1, v = 2 * y / p.height - 1;
  return p.light *
         (1 - 0.5 * p.uneven * (u * u + v * v) + 0.1 * p.uneven * std::sin(5 * u + 2) * std::sin(7 * v));
}

using Vec4 = Eigen::Vector4d;

// A disc's profile on the rectangle of pixels that it darkens.
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
  [[nodiscard]] const cv::Rect& window() const { return window_; }

  // Mean of f(dx, dy, r) over the pixel and the path.
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
  [[nodiscard]] double covered(int x, int y) const {
    return mean(x, y, [&](double, double, double r) { return profile_.value(r); });
  }
  // d(a P)/d(x, y, R, a)
  [[nodiscard]] Vec4 gradient(int x, int y) const {
    return mean(x, y, [&](double dx, double dy, double r) -> Vec4 {
      const double slope = disc_.contrast * profile_.by_distance(r) / std::max(r, 1e-9);
      return {-slope * dx, -slope * dy, disc_.contrast * profile_.by_radius(r), profile_.value(r)};
    });
  }
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

// Stores one profile per radius.
class Profiles {
 public:
  explicit Profiles(double blur) : blur_(blur) {}
  const BlurredDisc& of(double radius) { return profiles_.try_emplace(radius, radius, blur_).first->second; }

 private:
  double blur_;
  std::map<double, BlurredDisc> profiles_;
};

double variance(double level, double light, const Picture& p, double snr) {
  const double sigma = p.light / snr;
  return sigma * sigma * (kReadShare + (1 - kReadShare) * std::max(0.0, level - p.pedestal) / light);
}

}  // namespace

cv::Mat1d expected(const Picture& picture) {
  cv::Mat1d share(picture.height, picture.width, 1.0);
  Profiles profiles(picture.blur);
  for (const Disc& disc : picture.discs) {
    const Stamp stamp(picture, disc, profiles.of(disc.radius));
    const cv::Rect& w = stamp.window();
    for (int y = w.y; y < w.y + w.height; ++y)
      for (int x = w.x; x < w.x + w.width; ++x)
        share(y, x) += stamp.glare(x, y) - disc.contrast * stamp.covered(x, y);
  }
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      share(y, x) = picture.pedestal + light_at(picture, x, y) * share(y, x);
  return share;
}

cv::Mat1b expose(const cv::Mat1d& expected, const Picture& picture, double snr, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  cv::Mat1b picture8(expected.size());
  for (int y = 0; y < expected.rows; ++y)
    for (int x = 0; x < expected.cols; ++x)
      picture8(y, x) = cv::saturate_cast<uchar>(
          expected(y, x) +
          std::sqrt(variance(expected(y, x), picture.light, picture, snr)) * normal(generator));
  return picture8;
}

std::vector<double> cramer_rao_bound(const cv::Mat1d& expected, const Picture& picture, double snr) {
  constexpr double kRounding = 1.0 / 12;
  const double sigma = picture.light / snr, slope = sigma * sigma * (1 - kReadShare) / picture.light;
  // Weights: information per pixel about its grey level I, times the squared light, as I = ... - light a P.
  cv::Mat1d weight(expected.size());
  for (int y = 0; y < weight.rows; ++y)
    for (int x = 0; x < weight.cols; ++x) {
      const double v = variance(expected(y, x), picture.light, picture, snr) + kRounding;
      const double light = light_at(picture, x, y);
      weight(y, x) = light * light * (1 / v + 0.5 * slope * slope / (v * v));
    }

  // Gradients: d(a P)/d(x, y, R, a) of each disc on its own pixels.
  struct Gradient {
    cv::Rect window;
    std::vector<Vec4> of;
  };
  Profiles profiles(picture.blur);
  std::vector<Gradient> gradients;
  for (const Disc& disc : picture.discs) {
    const Stamp stamp(picture, disc, profiles.of(disc.radius));
    Gradient g{stamp.window(), {}};
    for (int y = g.window.y; y < g.window.y + g.window.height; ++y)
      for (int x = g.window.x; x < g.window.x + g.window.width; ++x) g.of.push_back(stamp.gradient(x, y));
    gradients.push_back(std::move(g));
  }
  auto information = [&](const Gradient& a, const Gradient& b) {
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    const cv::Rect both = a.window & b.window;
    for (int y = both.y; y < both.y + both.height; ++y)
      for (int x = both.x; x < both.x + both.width; ++x) {
        const Vec4& ga = a.of[static_cast<std::size_t>((y - a.window.y) * a.window.width + x - a.window.x)];
        const Vec4& gb = b.of[static_cast<std::size_t>((y - b.window.y) * b.window.width + x - b.window.x)];
        sum += weight(y, x) * ga * gb.transpose();
      }
    return sum;
  };

  // Blocks: Fisher information of each pair of discs whose blurred rims touch.
  const std::size_t n = picture.discs.size();
  std::vector<std::vector<std::size_t>> near(n);
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Matrix4d> block;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j <= k; ++j) {
      const Disc &a = picture.discs[k], &b = picture.discs[j];
      const double reach = a.radius + b.radius + 6 * picture.blur + std::hypot(a.path_x, a.path_y);
      if (std::abs(a.x - b.x) > reach || std::abs(a.y - b.y) > reach) continue;
      block[{k, j}] = information(gradients[k], gradients[j]);
      near[k].push_back(j);
      if (j != k) near[j].push_back(k);
    }
  // Bound: the information matrix of a disc and its neighbours is inverted, for the variances of x and y.
  std::vector<double> bound;
  for (std::size_t k = 0; k < n; ++k) {
    const auto m = static_cast<Eigen::Index>(near[k].size());
    Eigen::MatrixXd fisher = Eigen::MatrixXd::Zero(4 * m, 4 * m);
    Eigen::Index own = 0;
    for (Eigen::Index a = 0; a < m; ++a) {
      const std::size_t p = near[k][static_cast<std::size_t>(a)];
      if (p == k) own = a;
      for (Eigen::Index b = 0; b < m; ++b) {
        const std::size_t q = near[k][static_cast<std::size_t>(b)];
        const auto found = block.find({std::max(p, q), std::min(p, q)});
        if (found == block.end()) continue;
        if (p >= q)
          fisher.block<4, 4>(4 * a, 4 * b) = found->second;
        else
          fisher.block<4, 4>(4 * a, 4 * b) = found->second.transpose();
      }
      // A disc outside the frame has no information; this term keeps the matrix invertible.
      fisher.block<4, 4>(4 * a, 4 * a) += 1e-6 * Eigen::Matrix4d::Identity();
    }
    Eigen::MatrixXd two = Eigen::MatrixXd::Zero(4 * m, 2);
    two(4 * own, 0) = two(4 * own + 1, 1) = 1;
    const Eigen::MatrixXd columns = fisher.ldlt().solve(two);
    bound.push_back(std::sqrt(0.5 * (columns(4 * own, 0) + columns(4 * own + 1, 1))));
  }
  return bound;
}

}  // namespace twincell::imaging::rendered
