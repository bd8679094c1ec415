#include "analysis/neighbours/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "core/cancellation.hpp"

namespace twincell::analysis {
namespace {

using Cell = std::array<std::int64_t, 3>;

/// Layout of search cells that are at least one cutoff wide. A periodic axis is divided evenly, or not at all
/// if fewer than 3 cells fit.
class CellLayout {
 public:
  CellLayout(const Box& box, double cutoff, const Vec3& lowest) : box_(box) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      if (box.boundary[a] != Boundary::periodic) {
        origin_[axis] = lowest[axis];
        width_[axis] = cutoff;
        continue;
      }
      const double period = box.upper[axis] - box.lower[axis];
      const double fitting = std::min(std::floor(period / cutoff), static_cast<double>(kMaxCell));
      origin_[axis] = box.lower[axis];
      periodic_count_[a] = fitting >= 3 ? static_cast<std::int64_t>(fitting) : 1;
      alone_[a] = periodic_count_[a] == 1;
      width_[axis] = period / static_cast<double>(periodic_count_[a]);
    }
  }

  [[nodiscard]] Cell cell_of(const Vec3& r) const {
    const Vec3 wrapped = box_.wrap(r);
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      const double last = static_cast<double>(periodic_count_[a] > 0 ? periodic_count_[a] - 1 : kMaxCell);
      // Distant beads share the last cell: the search there is slower, but no neighbour is missed.
      cell[a] = static_cast<std::int64_t>(
          std::clamp(std::floor((wrapped[axis] - origin_[axis]) / width_[axis]), 0.0, last));
    }
    return cell;
  }

  /// Number of cells to search on either side along axis a, so that every cell within a cutoff is visited
  /// once.
  [[nodiscard]] std::int64_t reach(std::size_t a) const { return alone_[a] ? 0 : 1; }
  /// Declares that all beads are in one layer of cells along axis a, as planar beds are along y.
  void one_layer(std::size_t a) { alone_[a] = true; }
  [[nodiscard]] bool periodic(std::size_t a) const { return periodic_count_[a] > 0; }

  [[nodiscard]] std::uint64_t key(Cell cell) const {
    std::uint64_t packed = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (periodic_count_[a] > 0) cell[a] = (cell[a] + periodic_count_[a]) % periodic_count_[a];
      packed = (packed << kBits) |
               static_cast<std::uint64_t>(cell[a] + 1);  // + 1: one step below cell 0 stays non-negative
    }
    return packed;
  }

 private:
  static constexpr int kBits = 21;
  static constexpr std::int64_t kMaxCell = (std::int64_t{1} << kBits) - 4;
  const Box& box_;
  Vec3 origin_ = Vec3::Zero();
  Vec3 width_ = Vec3::Ones();
  std::array<std::int64_t, 3> periodic_count_ = {0, 0, 0};
  std::array<bool, 3> alone_ = {false, false, false};
};

struct Entry {
  std::uint64_t key;
  std::size_t bead;
};

}  // namespace

Neighbours find_neighbours(const Frame& frame, const Box& box, double cutoff) {
  assert(cutoff > 0);
  const std::size_t n = frame.position.size();
  Neighbours result;
  result.cutoff = cutoff;
  result.first.assign(n + 1, 0);

  std::vector<std::size_t> beads;
  Vec3 lowest = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i)
    if (frame.present(i) && frame.position[i].allFinite()) {
      beads.push_back(i);
      lowest = lowest.cwiseMin(frame.position[i]);
    }
  if (beads.empty()) return result;

  // Sort the beads by cell, so that the beads of a cell are consecutive. Axes with a single layer are not
  // searched.
  CellLayout layout(box, cutoff, lowest);
  std::vector<Entry> sorted;
  sorted.reserve(beads.size());
  std::vector<Cell> cell(n);
  std::array<bool, 3> one_layer = {true, true, true};
  for (const std::size_t i : beads) {
    cell[i] = layout.cell_of(frame.position[i]);
    sorted.push_back({layout.key(cell[i]), i});
    for (std::size_t a = 0; a < 3; ++a) one_layer[a] = one_layer[a] && cell[i][a] == cell[beads.front()][a];
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (one_layer[a]) layout.one_layer(a);
  std::sort(sorted.begin(), sorted.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.bead < b.bead; });

  // Search the adjacent cells of each bead, and sort its neighbours so that the order of the cells has no
  // effect.
  const double cutoff2 = cutoff * cutoff;
  struct Found {
    std::size_t bead;
    Vec3 bond;
  };
  std::vector<Found> found;
  auto next = beads.begin();
  for (std::size_t i = 0; i < n; ++i) {
    result.first[i] = result.index.size();
    if (next == beads.end() || *next != i) continue;
    throw_if_cancelled();
    ++next;
    found.clear();
    const Cell& home = cell[i];
    const auto look = [&](std::uint64_t first_key, std::uint64_t last_key) {
      auto entry = std::lower_bound(sorted.begin(), sorted.end(), first_key,
                                    [](const Entry& e, std::uint64_t k) { return e.key < k; });
      for (; entry != sorted.end() && entry->key <= last_key; ++entry) {
        if (entry->bead == i) continue;
        const Vec3 bond = box.nearest_image(frame.position[entry->bead] - frame.position[i]);
        if (bond.squaredNorm() <= cutoff2) found.push_back({entry->bead, bond});
      }
    };
    const std::int64_t up = layout.reach(2);
    for (std::int64_t dx = -layout.reach(0); dx <= layout.reach(0); ++dx)
      for (std::int64_t dy = -layout.reach(1); dy <= layout.reach(1); ++dy) {
        const auto key = [&](std::int64_t dz) {
          return layout.key({home[0] + dx, home[1] + dy, home[2] + dz});
        };
        if (!layout.periodic(2))
          look(key(-up), key(up));  // the keys of one column are consecutive
        else
          for (std::int64_t dz = -up; dz <= up; ++dz) look(key(dz), key(dz));
      }
    std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.bead < b.bead; });
    for (const Found& f : found) {
      result.index.push_back(f.bead);
      result.bond.push_back(f.bond);
    }
  }
  result.first[n] = result.index.size();
  return result;
}

}  // namespace twincell::analysis
