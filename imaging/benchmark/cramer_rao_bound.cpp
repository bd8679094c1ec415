#include "imaging/benchmark/cramer_rao_bound.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "imaging/benchmark/stamp.hpp"

namespace twincell::imaging::rendered {

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
