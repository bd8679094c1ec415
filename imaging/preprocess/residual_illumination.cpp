#include "imaging/preprocess/residual_illumination.hpp"

#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

namespace twincell::imaging {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Energy of a bent plate: the sum of the squared second differences, as a matrix.
Sparse bending(cv::Size size) {
  std::vector<Eigen::Triplet<double>> terms;
  int row = 0;
  const auto at = [&](int x, int y) { return y * size.width + x; };
  const auto difference = [&](std::initializer_list<std::pair<int, double>> stencil) {
    for (const auto& [k, weight] : stencil) terms.emplace_back(row, k, weight);
    ++row;
  };
  const double mixed = std::sqrt(2.0);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (x + 2 < size.width) difference({{at(x, y), 1}, {at(x + 1, y), -2}, {at(x + 2, y), 1}});
      if (y + 2 < size.height) difference({{at(x, y), 1}, {at(x, y + 1), -2}, {at(x, y + 2), 1}});
      if (x + 1 < size.width && y + 1 < size.height)
        difference(
            {{at(x, y), mixed}, {at(x + 1, y), -mixed}, {at(x, y + 1), -mixed}, {at(x + 1, y + 1), mixed}});
    }
  Sparse d(row, size.area());
  d.setFromTriplets(terms.begin(), terms.end());
  return d.transpose() * d;
}

/// The plate fitted to the tiles with nonzero weight.
Eigen::VectorXd plate(const Sparse& bend, const Eigen::VectorXd& mean, const Eigen::VectorXd& weight) {
  Sparse a = bend;
  constexpr double kHeld = 1e-9;  // keeps the matrix regular where no tile has weight
  for (Eigen::Index k = 0; k < weight.size(); ++k) a.coeffRef(k, k) += weight[k] + kHeld;
  const Eigen::SimplicialLDLT<Sparse> solver(a);
  return solver.solve(weight.cwiseProduct(mean));
}

}  // namespace

bool has_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance) {
  constexpr double kMinSignificance = 5;  // standard deviations
  double together = 0, squares = 0;
  const auto pair = [&](int x, int y, int to_x, int to_y) {
    const double product = mean(y, x) * mean(to_y, to_x) / std::sqrt(variance(y, x) * variance(to_y, to_x));
    together += product;
    squares += product * product;
  };
  for (int y = 0; y < mean.rows; ++y)
    for (int x = 0; x < mean.cols; ++x) {
      if (x + 1 < mean.cols) pair(x, y, x + 1, y);
      if (y + 1 < mean.rows) pair(x, y, x, y + 1);
    }
  return together > kMinSignificance * std::sqrt(squares);
}

cv::Mat1f smooth_ripple(const cv::Mat1d& mean, const cv::Mat1d& variance) {
  constexpr std::array<double, 4> kStiff = {0.01, 0.1, 1, 10};
  const cv::Size size = mean.size();
  const auto n = static_cast<Eigen::Index>(mean.total());
  const Eigen::VectorXd m = Eigen::Map<const Eigen::VectorXd>(mean.ptr<double>(), n);
  const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(variance.ptr<double>(), n);
  Eigen::VectorXd weight = v.cwiseInverse();
  weight /= weight.mean();
  const Sparse bend = bending(size);
  // Stiffness: cross-validation on a checkerboard, each colour predicted from the other.
  double stiffness = 0, least = HUGE_VAL;
  for (const double stiff : kStiff) {
    double missed = 0;
    for (const int kept : {0, 1}) {
      Eigen::VectorXd half = weight;
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          if ((x + y) % 2 != kept) half[y * size.width + x] = 0;
      const Eigen::VectorXd told = plate(stiff * bend, m, half);
      missed += ((weight - half).array() * (told - m).array().square()).sum();
    }
    if (missed < least) least = missed, stiffness = stiff;
  }
  // Far from tiles with data the plate is unconstrained, so it is limited to the range of the means.
  const Eigen::VectorXd s = plate(stiffness * bend, m, weight).cwiseMax(m.minCoeff()).cwiseMin(m.maxCoeff());
  cv::Mat1f map(size);
  for (Eigen::Index k = 0; k < n; ++k)
    map(static_cast<int>(k) / size.width, static_cast<int>(k) % size.width) = static_cast<float>(s[k]);
  return map;
}

}  // namespace twincell::imaging
