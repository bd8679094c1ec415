#include "analysis/motion/rolls.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace twincell::analysis {
namespace {

constexpr std::size_t kDraws = 999;

/// The loops that have a circulation, and their adjacency.
class Loops {
 public:
  Loops(const std::vector<double>& circulation, std::size_t columns, bool periodic)
      : columns_(columns),
        rows_(circulation.size() / columns),
        periodic_(periodic),
        number_(circulation.size(), kNone) {
    for (std::size_t p = 0; p < circulation.size(); ++p)
      if (std::isfinite(circulation[p])) {
        number_[p] = place_.size();
        place_.push_back(p);
      }
  }
  [[nodiscard]] std::size_t n() const { return place_.size(); }
  [[nodiscard]] std::size_t place(std::size_t i) const { return place_[i]; }

  template <class Visit>
  void for_each_neighbour(std::size_t i, const Visit& visit) const {
    const std::size_t p = place_[i], r = p / columns_, k = p % columns_;
    const auto go = [&](bool there, std::size_t q) {
      if (there && number_[q] != kNone) visit(number_[q]);
    };
    go(r > 0, p - columns_);
    go(r + 1 < rows_, p + columns_);
    if (columns_ < 2) return;
    go(k > 0 || periodic_, k > 0 ? p - 1 : p + columns_ - 1);
    go(k + 1 < columns_ || periodic_, k + 1 < columns_ ? p + 1 : p + 1 - columns_);
  }

  /// Solves for psi [n x m] for each column of `circulation` [n x m].
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& circulation) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < n(); ++i) {
      entries.emplace_back(i, i, 4);
      for_each_neighbour(i, [&](std::size_t j) { entries.emplace_back(i, j, -1); });
    }
    Eigen::SparseMatrix<double> laplacian(static_cast<Eigen::Index>(n()), static_cast<Eigen::Index>(n()));
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(laplacian);
    return factors.solve(circulation);
  }

  /// Connected regions of loops for which `in` is true.
  template <class In>
  [[nodiscard]] std::vector<std::vector<std::size_t>> regions(const In& in) const {
    std::vector<std::vector<std::size_t>> found;
    std::vector<char> seen(n(), 0);
    for (std::size_t start = 0; start < n(); ++start) {
      if (seen[start] != 0 || !in(start)) continue;
      seen[start] = 1;
      std::vector<std::size_t> region = {start};
      for (std::size_t next = 0; next < region.size(); ++next)
        for_each_neighbour(region[next], [&](std::size_t j) {
          if (seen[j] != 0 || !in(j)) return;
          seen[j] = 1;
          region.push_back(j);
        });
      found.push_back(std::move(region));
    }
    return found;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t columns_, rows_;
  bool periodic_;
  std::vector<std::size_t> number_;  ///< index of the loop at each place; kNone: no loop
  std::vector<std::size_t> place_;
};

/// t = mean/(standard error) over blocks, for blocks with the values psi [n x blocks] times `sign`.
Eigen::VectorXd t_values(const Eigen::MatrixXd& psi, const Eigen::VectorXd& squares,
                         const Eigen::VectorXd& sign) {
  const auto blocks = static_cast<double>(psi.cols());
  const Eigen::VectorXd mean = psi * sign / blocks;
  const Eigen::ArrayXd variance =
      (squares.array() - blocks * mean.array().square()).max(0.0) / (blocks - 1) / blocks;
  // Values that are equal in every block up to rounding get a finite t: the variance has a floor at the
  // rounding error.
  return (mean.array() / (variance + 1e-24 * squares.array()).max(std::numeric_limits<double>::min()).sqrt())
      .matrix();
}

}  // namespace

std::vector<double> stream_function(const std::vector<double>& circulation, std::size_t columns,
                                    bool periodic) {
  assert(columns > 0);
  const Loops loops(circulation, columns, periodic);
  std::vector<double> psi(circulation.size(), std::numeric_limits<double>::quiet_NaN());
  if (loops.n() == 0) return psi;
  Eigen::MatrixXd right(static_cast<Eigen::Index>(loops.n()), 1);
  for (std::size_t i = 0; i < loops.n(); ++i)
    right(static_cast<Eigen::Index>(i), 0) = circulation[loops.place(i)];
  const Eigen::MatrixXd solved = loops.solve(right);
  for (std::size_t i = 0; i < loops.n(); ++i) psi[loops.place(i)] = solved(static_cast<Eigen::Index>(i), 0);
  return psi;
}

std::size_t count_rolls(const CirculationBlocks& blocks, double least) {
  assert(blocks.blocks.size() >= kMinRollBlocks && blocks.columns > 0);
  const Loops loops(blocks.blocks.front(), blocks.columns, blocks.periodic);
  if (loops.n() == 0) return 0;
  const auto n = static_cast<Eigen::Index>(loops.n()),
             count = static_cast<Eigen::Index>(blocks.blocks.size());
  Eigen::MatrixXd circulation(n, count);
  for (Eigen::Index b = 0; b < count; ++b)
    for (Eigen::Index i = 0; i < n; ++i)
      circulation(i, b) =
          blocks.blocks[static_cast<std::size_t>(b)][loops.place(static_cast<std::size_t>(i))];
  const Eigen::MatrixXd psi = loops.solve(circulation);
  const Eigen::VectorXd squares = psi.rowwise().squaredNorm(), mean = psi.rowwise().mean();
  const Eigen::VectorXd t = t_values(psi, squares, Eigen::VectorXd::Ones(count));

  // Threshold T: distribution of the largest |t| under random signs of the blocks.
  std::mt19937_64 generator(1);
  std::vector<double> largest;
  Eigen::VectorXd sign(count);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    for (Eigen::Index b = 0; b < count; ++b) sign(b) = generator() >> 63 != 0 ? 1 : -1;
    largest.push_back(t_values(psi, squares, sign).cwiseAbs().maxCoeff());
  }
  std::sort(largest.begin(), largest.end());
  const double bound =
      largest[static_cast<std::size_t>(std::ceil((1 - kRollFalseAlarm) * static_cast<double>(kDraws + 1))) -
              1];

  // Regions of one sense that exceed T and are strong enough.
  const double weakest = std::max(least, kSmallestRoll * mean.cwiseAbs().maxCoeff());
  std::size_t rolls = 0;
  for (const double sense : {1.0, -1.0})
    for (const auto& region :
         loops.regions([&](std::size_t i) { return sense * t(static_cast<Eigen::Index>(i)) > bound / 2; })) {
      const auto any = [&](const Eigen::VectorXd& of, double above) {
        return std::any_of(region.begin(), region.end(),
                           [&](std::size_t i) { return sense * of(static_cast<Eigen::Index>(i)) > above; });
      };
      if (any(t, bound) && any(mean, weakest)) ++rolls;
    }
  return rolls;
}

}  // namespace twincell::analysis
