#include "imaging/refine/sparse_gauss_newton.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace twincell::imaging {

namespace {

constexpr int kMaxIterations = 40;
constexpr double kRelative = 1e-2;

}  // namespace

Normal normal_of(const RingSums& s) {
  Normal a;
  std::size_t at = 0;
  for (int m = 0; m < kFitted; ++m)
    for (int k = 0; k <= m; ++k, ++at) a(m, k) = a(k, m) = s.jj[at];
  return a;
}

Step right_side(const RingSums& s) {
  Step g;
  for (int m = 0; m < kFitted; ++m) g[m] = s.jr[static_cast<std::size_t>(m)];
  return g;
}

std::vector<std::array<std::int32_t, 2>> near_pairs(const std::vector<Disc>& discs, double reach) {
  std::vector<std::array<std::int32_t, 2>> pairs;
  if (discs.empty()) return pairs;
  pairs.reserve(3 * discs.size());  // the number of contacts in a crystal of equal discs
  double largest = 0, left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
  for (const Disc& d : discs) {
    largest = std::max(largest, d.radius);
    left = std::min(left, d.x), right = std::max(right, d.x);
    top = std::min(top, d.y), bottom = std::max(bottom, d.y);
  }
  const double cell = 2 * largest + reach;
  const int nx = 1 + static_cast<int>((right - left) / cell),
            ny = 1 + static_cast<int>((bottom - top) / cell);
  std::vector<std::int32_t> first(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), -1),
      next(discs.size());
  const auto place = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(x);
  };
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Disc& d = discs[i];
    const int column = static_cast<int>((d.x - left) / cell), row = static_cast<int>((d.y - top) / cell);
    // The candidates are the discs already sorted into cells, so each pair occurs once.
    for (int y = std::max(0, row - 1); y <= std::min(ny - 1, row + 1); ++y)
      for (int x = std::max(0, column - 1); x <= std::min(nx - 1, column + 1); ++x)
        for (std::int32_t j = first[place(x, y)]; j >= 0; j = next[static_cast<std::size_t>(j)]) {
          const Disc& other = discs[static_cast<std::size_t>(j)];
          const double far = d.radius + other.radius + reach, dx = d.x - other.x, dy = d.y - other.y;
          if (dx * dx + dy * dy < far * far) pairs.push_back({static_cast<std::int32_t>(i), j});
        }
    std::int32_t& head = first[place(column, row)];
    next[i] = head;
    head = static_cast<std::int32_t>(i);
  }
  return pairs;
}

void renew(Coupling& c, const RingArgs& args, const std::vector<Disc>& discs) {
  // Farther than this from one of the two edges, its slope is negligible. Omitting these pixels from the
  // coupling keeps the matrix positive definite, because they still count in both diagonal blocks.
  constexpr double kEdgeReach = 3;  // widths of the blur
  RingArgs narrow = args;
  narrow.ring = std::min(args.ring, args.blur.reach(kEdgeReach));
  const PairSums sums =
      pair_sums(narrow, discs[static_cast<std::size_t>(c.i)], discs[static_cast<std::size_t>(c.j)]);
  c.sums = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(sums.data());
}

std::vector<Coupling> couplings_of(const RingArgs& args, const std::vector<Disc>& discs) {
  constexpr double kMaxEdgeGap = 3;  // widths of the blur; edges farther apart share almost no pixels
  const auto pairs = near_pairs(discs, std::min(2 * args.ring, args.blur.reach(kMaxEdgeGap)));
  std::vector<Coupling> couplings;
  couplings.reserve(pairs.size());
  for (const auto& [i, j] : pairs) couplings.push_back({i, j, Normal::Zero()});
  return couplings;
}

std::vector<Step> gauss_newton_step(const std::vector<Normal>& blocks, const std::vector<Coupling>& couplings,
                                    const std::vector<Step>& right) {
  const std::size_t n = blocks.size();
  // Preconditioner: the inverse of each diagonal block.
  std::vector<Normal> alone;
  alone.reserve(n);
  for (const Normal& a : blocks) alone.emplace_back(a.inverse());

  std::vector<Step> x(n, Step::Zero()), r = right, z(n), p(n), ap(n);
  double rz = 0;
  for (std::size_t k = 0; k < n; ++k) {
    z[k] = p[k] = alone[k] * r[k];
    rz += r[k].dot(z[k]);
  }
  const double enough = kRelative * kRelative * rz;
  for (int iteration = 0; iteration < kMaxIterations && rz > enough && rz > 0; ++iteration) {
    for (std::size_t k = 0; k < n; ++k) ap[k] = blocks[k] * p[k];
    for (const Coupling& c : couplings) {
      const auto i = static_cast<std::size_t>(c.i), j = static_cast<std::size_t>(c.j);
      ap[i] += c.sums * p[j];
      ap[j] += c.sums.transpose() * p[i];
    }
    double pap = 0;
    for (std::size_t k = 0; k < n; ++k) pap += p[k].dot(ap[k]);
    if (!(pap > 0)) break;  // rounding error; the present x is still a usable step
    const double alpha = rz / pap;
    double rz_new = 0;
    for (std::size_t k = 0; k < n; ++k) {
      x[k] += alpha * p[k];
      r[k] -= alpha * ap[k];
      z[k] = alone[k] * r[k];
      rz_new += r[k].dot(z[k]);
    }
    for (std::size_t k = 0; k < n; ++k) p[k] = z[k] + rz_new / rz * p[k];
    rz = rz_new;
  }
  return x;
}

}  // namespace twincell::imaging
