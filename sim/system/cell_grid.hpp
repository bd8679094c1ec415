#pragma once
/// \file
/// Neighbour search: pairs of beads near each other, in time and memory proportional to the number of beads.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/system/nearest_image.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

/// Position of a bead, sigma.
inline Vec3 centre_of(const Bead& b) {
  return {b.x, b.y, b.z};
}

/// Shift to the nearest periodic image, sigma: r + nearest_shift(r) is the shortest. Period 0: not periodic.
inline Vec3 nearest_shift(const Vec3& r, const std::array<double, 3>& period) {
  Vec3 shift = Vec3::Zero();
  for (int a = 0; a < 3; ++a) shift[a] = nearest_shift(r[a], period[static_cast<std::size_t>(a)]);
  return shift;
}

/// Hash table of beads by the cell that contains them. Only occupied cells exist, so a bead at z = 1e4 costs
/// nothing. Each size class (radii within a factor of two) has its own cell size, so a cell contains few
/// small beads even if other beads are a hundred times larger.
class CellGrid {
 public:
  /// \param radii of all beads that will be inserted or used in a search
  /// \param margin gap between surfaces up to which around() finds beads
  /// \param dimension 2: y is ignored
  /// \param period of x, y, z; 0: not periodic
  CellGrid(const std::vector<double>& radii, double margin, int dimension,
           const std::array<double, 3>& period)
      : dimension_(dimension), period_(period), next_(radii.size(), -1) {
    std::size_t capacity = 16;
    while (capacity < 2 * radii.size()) capacity *= 2;
    slots_.resize(capacity);
    for (const double r : radii) largest_ = std::max(largest_, r);
    std::array<double, kClasses> reach{};
    for (const double r : radii) {
      double& of_class = reach[static_cast<std::size_t>(size_class(r))];
      of_class = std::max(of_class, 2 * r + margin);
    }
    // Cells exceed the reach by more than rounding can move a bead across cells.
    constexpr double kSlack = 1 + 1e-6, kMinEdge_sigma = 1e-12;
    for (std::size_t k = 0; k < kClasses; ++k)
      for (std::size_t a = 0; a < 3; ++a) {
        const double edge = std::max(reach[k] * kSlack, kMinEdge_sigma);
        levels_[k].count[a] =
            period[a] > 0 ? static_cast<std::int64_t>(std::clamp(std::floor(period[a] / edge), 1.0, kMaxCell))
                          : 0;
        levels_[k].edge[a] = period[a] > 0 ? period[a] / static_cast<double>(levels_[k].count[a]) : edge;
      }
  }

  /// Size class of a radius: 0 for radii in (largest/2, largest], 1 for the next half, and so on.
  [[nodiscard]] int size_class(double radius) const {
    const double ratio = largest_ / radius;
    return ratio >= 1 && std::isfinite(ratio) ? std::min(std::ilogb(ratio), kClasses - 1)
           : ratio < 1                        ? 0
                                              : kClasses - 1;
  }

  /// Inserts a bead with centre r and radius, both in sigma. A bead without a finite position is left out.
  void insert(std::int32_t bead, const Vec3& r, double radius) {
    if (!r.allFinite()) return;
    const int k = size_class(radius);
    Level& level = levels_[static_cast<std::size_t>(k)];
    ++level.beads;
    const std::uint64_t here = key(k, cell(level, r));
    Slot& slot = slots_[find(here)];
    slot.key = here;
    next_[static_cast<std::size_t>(bead)] = slot.first;
    slot.first = bead;
  }

  /// Calls visit(j) once for every inserted bead of the size class of `radius` or a larger one that may be
  /// within the margin of a bead at r. A few visited beads are farther away.
  template <class Visit>
  void around(const Vec3& r, double radius, Visit visit) const {
    if (!r.allFinite()) return;
    for (int k = size_class(radius); k >= 0; --k) {
      const Level& level = levels_[static_cast<std::size_t>(k)];
      if (level.beads == 0) continue;
      const Cell home = cell(level, r);
      // With fewer than three periodic cells, the neighbours on both sides are the same cell.
      const auto first = [&](std::size_t a) {
        return (dimension_ == 2 && a == 1) || level.count[a] == 1 ? 0 : -1;
      };
      const auto last = [&](std::size_t a) { return first(a) == 0 || level.count[a] == 2 ? 0 : 1; };
      for (int dz = first(2); dz <= last(2); ++dz)
        for (int dy = first(1); dy <= last(1); ++dy)
          for (int dx = first(0); dx <= last(0); ++dx) {
            const Cell c = {wrapped(level, 0, home[0] + dx), wrapped(level, 1, home[1] + dy),
                            wrapped(level, 2, home[2] + dz)};
            for (std::int32_t j = slots_[find(key(k, c))].first; j >= 0;
                 j = next_[static_cast<std::size_t>(j)])
              visit(j);
          }
    }
  }

 private:
  static constexpr int kClasses = 15;  ///< a key has room for 16; the last is reserved for the empty key
  static constexpr double kMaxCell = 1 << 19;  ///< cells from the origin; cells beyond are merged into one
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  using Cell = std::array<std::int64_t, 3>;

  struct Level {
    std::array<double, 3> edge{};
    std::array<std::int64_t, 3> count{};  ///< number of cells across a period; 0: not periodic
    std::size_t beads = 0;
  };
  struct Slot {
    std::uint64_t key = kEmpty;
    std::int32_t first = -1;  ///< first bead of the cell; the others follow in next_
  };

  [[nodiscard]] Cell cell(const Level& level, const Vec3& r) const {
    Cell c{};
    for (std::size_t a = 0; a < 3; ++a) {
      if (dimension_ == 2 && a == 1) continue;
      double x = r[static_cast<int>(a)], low = -kMaxCell, high = kMaxCell;
      if (level.count[a] > 0) {
        x -= period_[a] * std::floor(x / period_[a]);
        low = 0;
        high = static_cast<double>(level.count[a] - 1);
      }
      c[a] = static_cast<std::int64_t>(std::clamp(std::floor(x / level.edge[a]), low, high));
    }
    return c;
  }
  static std::int64_t wrapped(const Level& level, std::size_t a, std::int64_t c) {
    const std::int64_t count = level.count[a];
    if (count == 0) return c;
    return c < 0 ? c + count : c >= count ? c - count : c;
  }
  static std::uint64_t key(int size_class, const Cell& c) {
    std::uint64_t k = static_cast<std::uint64_t>(size_class);
    for (const std::int64_t x : c)  // beyond 20 bits opposite ends share a key: only a distance test more
      k = (k << 20) | (static_cast<std::uint64_t>(x + (std::int64_t{1} << 19)) & 0xFFFFF);
    return k;
  }
  /// Slot of a key, or the empty slot where it would be inserted.
  [[nodiscard]] std::size_t find(std::uint64_t k) const {
    std::uint64_t h = k * 0x9E3779B97F4A7C15u;
    h ^= h >> 32;
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>(h) & mask;
    while (slots_[at].key != k && slots_[at].key != kEmpty) at = (at + 1) & mask;
    return at;
  }

  double largest_ = 0;
  int dimension_;
  std::array<double, 3> period_;
  std::array<Level, kClasses> levels_;
  std::vector<Slot> slots_;
  std::vector<std::int32_t> next_;
};

/// Calls visit(i, j, gap, shift) once for every pair i < j whose surfaces are closer than `margin`. The order
/// is unspecified but reproducible. gap is negative for overlapping beads; r_i - r_j + shift is the
/// separation of nearest images. Periods must be at least twice R_i + R_j + margin of every pair, so that no
/// other image is in range.
template <class Visit>
void for_each_near_pair(const std::vector<Bead>& beads, int dimension, const std::array<double, 3>& period,
                        double margin, Visit visit) {
  const auto look_at = [&](std::int32_t i, std::int32_t j) {
    const Bead &p = beads[static_cast<std::size_t>(i)], &q = beads[static_cast<std::size_t>(j)];
    const Vec3 apart = centre_of(p) - centre_of(q);
    const double reach = p.radius + q.radius, far = reach + margin;
    if (period[2] == 0 && std::abs(apart.z()) > far) return;
    const Vec3 shift = nearest_shift(apart, period);
    const double square = (apart + shift).squaredNorm();
    if (square > far * far) return;
    const double gap = std::sqrt(square) - reach;
    if (gap < margin) visit(i, j, gap, shift);
  };
  // Few beads: testing every pair is faster than filling a grid of cells.
  constexpr std::size_t kMaxPairLoopBeads = 150, kMaxPlainLoopBeads = 12;
  if (beads.size() <= kMaxPairLoopBeads) {
    const auto look_at_all_before = [&](std::size_t j) {
      for (std::size_t i = 0; i < j; ++i) look_at(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    };
    if (beads.size() <= kMaxPlainLoopBeads) {
      for (std::size_t j = 1; j < beads.size(); ++j) look_at_all_before(j);
      return;
    }
    // Most beads have no near neighbour. A plain loop over contiguous arrays finds these fast.
    std::vector<double> at[3], radius;
    for (const Bead& b : beads) {
      at[0].push_back(b.x), at[1].push_back(b.y), at[2].push_back(b.z);
      radius.push_back(b.radius);
    }
    const double per[3] = {period[0] > 0 ? 1 / period[0] : 0, period[1] > 0 ? 1 / period[1] : 0,
                           period[2] > 0 ? 1 / period[2] : 0};
    constexpr double kMore = 1 + 1e-9;  // look_at() decides; its rounding differs
    for (std::size_t j = 1; j < beads.size(); ++j) {
      const double x = at[0][j], y = at[1][j], z = at[2][j], reach = kMore * (radius[j] + margin);
      int near = 0;
      for (std::size_t i = 0; i < j; ++i) {
        double dx = at[0][i] - x, dy = at[1][i] - y, dz = at[2][i] - z;
        dx -= period[0] * nearest_whole(dx * per[0]);
        dy -= period[1] * nearest_whole(dy * per[1]);
        dz -= period[2] * nearest_whole(dz * per[2]);
        const double far = reach + kMore * radius[i];
        near |= dx * dx + dy * dy + dz * dz <= far * far ? 1 : 0;
      }
      if (near != 0) look_at_all_before(j);
    }
    return;
  }
  std::vector<double> radii;
  radii.reserve(beads.size());
  for (const Bead& b : beads) radii.push_back(b.radius);
  CellGrid grid(radii, margin, dimension, period);
  // Large beads first: each bead then only searches for beads of its own size class and larger ones.
  std::vector<std::pair<int, std::int32_t>> order;
  order.reserve(beads.size());
  for (const double r : radii)
    order.emplace_back(grid.size_class(r), static_cast<std::int32_t>(order.size()));
  std::sort(order.begin(), order.end());
  for (const auto& [size_class, k] : order) {
    const Bead& b = beads[static_cast<std::size_t>(k)];
    grid.around(centre_of(b), b.radius,
                [&, k = k](std::int32_t other) { look_at(std::min(k, other), std::max(k, other)); });
    grid.insert(k, centre_of(b), b.radius);
  }
}

}  // namespace twincell::sim
