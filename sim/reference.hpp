#pragma once
/// \file
/// The oracle: every pair at every step, history in a map, nothing clever. Same laws, same order of
/// summation, so the list kernel must agree with it to the last bit.

#include <map>
#include <utility>

#include "sim/contact.hpp"

namespace twincell::sim {

/// Forces over all pairs. Fills system.forces and returns the largest overlap.
template <class Laws>
class AllPairsForces {
 public:
  explicit AllPairsForces(const Laws& laws) : laws_(laws) {}

  double operator()(System& s) {
    const int n = static_cast<int>(s.beads.size());
    double largest = 0;
    for (int i = 0; i < n; ++i)
      at(s.forces, i) = {s.gravity_x * at(s.beads, i).mass, -s.gravity * at(s.beads, i).mass, 0};
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j) {
        const Bead &a = at(s.beads, i), &b = at(s.beads, j);
        const double dx = laws_.side.separation(a.x - b.x), dz = a.z - b.z;
        const double r2 = dx * dx + dz * dz, reach = a.radius + b.radius;
        if (r2 >= reach * reach) {
          history_.erase({i, j});
          continue;
        }
        const double m_eff = a.mass * b.mass / (a.mass + b.mass);
        const ContactForce f = pair_force(laws_.bead, a, b, dx, dz, m_eff, s.dt, history_[{i, j}]);
        add_force(at(s.forces, i), f, a.radius, 1);
        add_force(at(s.forces, j), f, b.radius, -1);
        largest = std::max(largest, reach - std::sqrt(r2));
      }
    const Walls walls(s);
    for (int i = 0; i < n; ++i)
      for (int w = 0; w < (Laws::Side::kWalls ? 3 : 1); ++w) {
        const double overlap = walls.of[w].overlap(at(s.beads, i));
        const std::pair key{i, -1 - w};
        if (overlap <= 0) {
          history_.erase(key);
          continue;
        }
        add_force(at(s.forces, i), wall_force(laws_.wall, at(s.beads, i), walls.of[w], s.dt, history_[key]),
                  at(s.beads, i).radius, 1);
        largest = std::max(largest, overlap);
      }
    return largest;
  }

  [[nodiscard]] std::int64_t builds() const { return 0; }
  void rebuild_every(std::int64_t) {}

 private:
  template <class T>
  static T& at(std::vector<T>& v, int i) {
    return v[static_cast<std::size_t>(i)];
  }

  Laws laws_;
  std::map<std::pair<int, int>, double> history_;
};

}  // namespace twincell::sim
