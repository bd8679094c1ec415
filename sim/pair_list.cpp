#include "sim/pair_list.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/contact.hpp"
#include "sim/laws/side.hpp"

namespace twincell::sim {

namespace {

struct Mean {
  double x = 0, z = 0;
};

Mean mean_position(const std::vector<Bead>& beads) {
  Mean m;
  for (const Bead& b : beads) {
    m.x += b.x;
    m.z += b.z;
  }
  const double n = static_cast<double>(std::max<std::size_t>(beads.size(), 1));
  return {m.x / n, m.z / n};
}

/// Beads sorted by the cell they are in. Only occupied rows and columns exist: a bead at z = 1e4 costs
/// nothing.
class CellGrid {
 public:
  CellGrid(const std::vector<Bead>& beads, double reach, double periodic_width) : reach_(reach) {
    columns_ =
        periodic_width > 0 ? std::max<std::int64_t>(1, static_cast<std::int64_t>(periodic_width / reach)) : 0;
    width_ = columns_ > 0 ? periodic_width / static_cast<double>(columns_) : reach;
    order_.reserve(beads.size());
    for (std::size_t i = 0; i < beads.size(); ++i)
      order_.push_back({key(column(beads[i].x), row(beads[i].z)), static_cast<std::int32_t>(i)});
    std::sort(order_.begin(), order_.end());
  }

  /// Calls visit(j) for every bead in the 3 x 3 cells around (x, z).
  template <class Visit>
  void around(double x, double z, Visit visit) const {
    const std::int64_t c = column(x), r = row(z);
    // With fewer than three periodic columns the neighbours on both sides are the same column.
    const std::int64_t first = columns_ == 1 ? 0 : -1, last = columns_ == 1 || columns_ == 2 ? 0 : 1;
    for (std::int64_t dc = first; dc <= last; ++dc)
      for (std::int64_t dr = -1; dr <= 1; ++dr) {
        const std::int64_t k = key(wrapped(c + dc), r + dr);
        for (auto at = std::lower_bound(order_.begin(), order_.end(), Entry{k, -1});
             at != order_.end() && at->key == k; ++at)
          visit(at->bead);
      }
  }

 private:
  struct Entry {
    std::int64_t key;
    std::int32_t bead;
    bool operator<(const Entry& o) const { return key != o.key ? key < o.key : bead < o.bead; }
  };
  [[nodiscard]] std::int64_t column(double x) const { return wrapped(whole(x / width_)); }
  [[nodiscard]] std::int64_t row(double z) const { return whole(z / reach_); }
  /// Coordinates beyond any cell, or none at all, share one far cell: the guard stops such a run, and until
  /// then the conversion must be defined.
  static std::int64_t whole(double q) {
    constexpr double kFar = 1e6;
    return std::abs(q) < kFar ? static_cast<std::int64_t>(std::floor(q)) : static_cast<std::int64_t>(kFar);
  }
  [[nodiscard]] std::int64_t wrapped(std::int64_t c) const {
    return columns_ > 0 ? ((c % columns_) + columns_) % columns_ : c;
  }
  static std::int64_t key(std::int64_t c, std::int64_t r) { return (r << 24) + c + (std::int64_t{1} << 23); }

  double reach_, width_;
  std::int64_t columns_;
  std::vector<Entry> order_;
};

}  // namespace

bool PairList::stale(const System& s) const {
  if (x_.size() != s.beads.size()) return true;
  const Mean now = mean_position(s.beads);
  const double common_x = now.x - mean_x_, common_z = now.z - mean_z_;
  double first = 0, second = 0;  // squares of the two largest displacements
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    const double dx = s.beads[i].x - x_[i] - common_x, dz = s.beads[i].z - z_[i] - common_z;
    const double d = dx * dx + dz * dz;
    if (!(d <= first)) {
      second = first;
      first = d;
    } else if (d > second) {
      second = d;
    }
  }
  const double fast = std::sqrt(first);
  const double against_plate = std::abs(common_z - (s.plate_height() - plate_));
  const double against_walls = std::max(against_plate, std::abs(common_x));
  // Negated, so that a position that is not a number makes the list stale and is found at the build.
  return !(fast + std::sqrt(second) <= skin_ && fast + against_walls <= skin_);
}

bool PairList::refresh(const System& system, bool always) {
  if (!always && !stale(system)) return false;
  build(system);
  return true;
}

void PairList::find_pairs(const System& s, std::vector<Pair>& found) const {
  double largest = 0;
  for (const Bead& b : s.beads) largest = std::max(largest, b.radius);
  const CellGrid grid(s.beads, 2 * largest + skin_, periodic_width_);
  const PeriodicSides sides{periodic_width_ > 0 ? periodic_width_ : 1};
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    const Bead& a = s.beads[i];
    const std::size_t begin = found.size();
    grid.around(a.x, a.z, [&](std::int32_t j) {
      if (j <= static_cast<std::int32_t>(i)) return;
      const Bead& b = s.beads[static_cast<std::size_t>(j)];
      const double dx = periodic_width_ > 0 ? sides.separation(a.x - b.x) : a.x - b.x, dz = a.z - b.z;
      const double reach = a.radius + b.radius + skin_;
      if (dx * dx + dz * dz < reach * reach)
        found.push_back({static_cast<std::int32_t>(i), j, a.mass * b.mass / (a.mass + b.mass), 0});
    });
    std::sort(found.begin() + static_cast<std::ptrdiff_t>(begin), found.end(),
              [](const Pair& p, const Pair& q) { return p.j < q.j; });
  }
}

void PairList::build(const System& s) {
  std::vector<Pair> found;
  found.reserve(pairs.size() + 16);
  find_pairs(s, found);
  // Both lists are sorted: one walk carries the history over.
  auto old = pairs.begin();
  for (Pair& p : found) {
    while (old != pairs.end() && (old->i < p.i || (old->i == p.i && old->j < p.j))) ++old;
    if (old != pairs.end() && old->i == p.i && old->j == p.j) p.xi = old->xi;
  }
  pairs.swap(found);

  const Walls walls(s);
  std::vector<WallContact> near;
  auto before = wall_contacts.begin();
  for (std::size_t i = 0; i < s.beads.size(); ++i)
    for (int w = 0; w < (side_walls_ ? 3 : 1); ++w) {
      if (!(walls.of[w].overlap(s.beads[i]) > -skin_)) continue;
      WallContact contact{static_cast<std::int32_t>(i), w, 0};
      while (before != wall_contacts.end() &&
             (before->bead < contact.bead || (before->bead == contact.bead && before->wall < w)))
        ++before;
      if (before != wall_contacts.end() && before->bead == contact.bead && before->wall == w)
        contact.xi = before->xi;
      near.push_back(contact);
    }
  wall_contacts.swap(near);

  x_.resize(s.beads.size());
  z_.resize(s.beads.size());
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    x_[i] = s.beads[i].x;
    z_[i] = s.beads[i].z;
  }
  const Mean m = mean_position(s.beads);
  mean_x_ = m.x;
  mean_z_ = m.z;
  plate_ = s.plate_height();
  ++builds_;
}

}  // namespace twincell::sim
