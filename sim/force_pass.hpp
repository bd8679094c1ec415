#pragma once
/// \file
/// The contact loop over a pair list, for any set of laws. What a law does not need is not compiled in.

#include "sim/contact.hpp"
#include "sim/pair_list.hpp"

namespace twincell::sim {

/// Forces by neighbour list. Fills system.forces at the present positions and returns the largest overlap
/// seen.
template <class Laws>
class ListForces {
 public:
  ListForces(const Laws& laws, double skin)
      : laws_(laws), list_(skin, Laws::Side::kWalls ? 0 : laws.side.width, Laws::Side::kWalls) {}

  /// Must be called after positions changed by other means than the integrator.
  double operator()(System& s) {
    list_.refresh(s, rebuild_every_ > 0 && ++calls_ % rebuild_every_ == 0);
    for (std::size_t i = 0; i < s.beads.size(); ++i)
      s.forces[i] = {s.gravity_x * s.beads[i].mass, -s.gravity * s.beads[i].mass, 0};
    double largest = 0;
    for (Pair& p : list_.pairs) {
      const Bead &a = s.beads[static_cast<std::size_t>(p.i)], &b = s.beads[static_cast<std::size_t>(p.j)];
      const double dx = laws_.side.separation(a.x - b.x), dz = a.z - b.z, reach = a.radius + b.radius;
      const double r2 = dx * dx + dz * dz;
      if (r2 >= reach * reach) {
        if constexpr (Laws::Tangential::kNeedsHistory) p.xi = 0;
        continue;
      }
      const ContactForce f = pair_force(laws_.bead, a, b, dx, dz, p.m_eff, s.dt, p.xi);
      add_force(s.forces[static_cast<std::size_t>(p.i)], f, a.radius, 1);
      add_force(s.forces[static_cast<std::size_t>(p.j)], f, b.radius, -1);
      largest = std::max(largest, reach - std::sqrt(r2));
    }
    const Walls walls(s);
    for (WallContact& c : list_.wall_contacts) {
      const Bead& b = s.beads[static_cast<std::size_t>(c.bead)];
      const Wall& wall = walls.of[c.wall];
      const double overlap = wall.overlap(b);
      if (overlap <= 0) {
        if constexpr (Laws::Tangential::kNeedsHistory) c.xi = 0;
        continue;
      }
      add_force(s.forces[static_cast<std::size_t>(c.bead)], wall_force(laws_.wall, b, wall, s.dt, c.xi),
                b.radius, 1);
      largest = std::max(largest, overlap);
    }
    return largest;
  }

  [[nodiscard]] std::int64_t builds() const { return list_.builds(); }
  /// For tests: also rebuild every n-th call; the result must not change by a bit.
  void rebuild_every(std::int64_t n) { rebuild_every_ = n; }

 private:
  Laws laws_;
  PairList list_;
  std::int64_t rebuild_every_ = 0, calls_ = 0;
};

}  // namespace twincell::sim
