#include "sim/event_driven/cluster.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

Vec3 velocity(const Bead& b) {
  return {b.vx, b.vy, b.vz};
}

bool apart(const System& s) {
  for (const Wall& wall : s.walls) {
    const double offset = offset_now(s, wall);
    for (const Bead& b : s.beads)
      if (wall.n.dot(centre_of(b)) - offset < b.radius) return false;
  }
  bool touch = false;
  for_each_near_pair(s.beads, s.dimension, s.period, 0,
                     [&](std::int32_t, std::int32_t, double, const Vec3&) { touch = true; });
  return !touch;
}

}  // namespace

Cluster take_out(const System& whole, const std::vector<ContactMemory>& memories,
                 std::vector<std::int32_t> members) {
  Cluster h;
  h.start = whole;
  h.start.beads.clear(), h.start.forces.clear(), h.start.rim_speeds.clear();
  for (const std::int32_t m : members) {
    h.start.beads.push_back(whole.beads[static_cast<std::size_t>(m)]);
    h.start.forces.push_back(whole.forces[static_cast<std::size_t>(m)]);
  }
  const auto place = [&](std::int32_t bead) {
    const auto at = std::lower_bound(members.begin(), members.end(), bead);
    return at != members.end() && *at == bead ? static_cast<std::int32_t>(at - members.begin()) : -1;
  };
  for (const ContactMemory& m : memories) {
    const std::int32_t i = place(m.i), j = m.j < 0 ? m.j : place(m.j);
    if (i >= 0 && (m.j < 0 || j >= 0)) h.memories.push_back({i, j, m.values});
  }
  h.members = std::move(members);
  return h;
}

ClusterState after(const Cluster& cluster, std::int64_t steps,
                   const std::function<std::unique_ptr<Solver>()>& make_solver) {
  ClusterState state{cluster.start, cluster.memories};
  if (steps == 0) return state;
  const auto moving = make_solver();
  moving->restore(cluster.memories);
  moving->advance(state.system, steps);
  state.memories = moving->contacts();
  return state;
}

std::optional<System> separate_cluster(Cluster& cluster, std::int64_t contact, std::int64_t most,
                                       const std::function<std::unique_ptr<Solver>()>& make_solver) {
  const std::int64_t every = std::max<std::int64_t>(1, contact / 8);
  System s = cluster.start;
  const auto moving = make_solver();
  moving->restore(cluster.memories);
  cluster.stray.assign(s.beads.size(), 0);
  std::vector<double> fastest(s.beads.size(), 0);  // largest speed relative to free flight
  cluster.steps = 0;
  const auto advance = [&](std::int64_t steps) {
    moving->advance(s, steps);
    cluster.steps += steps;
    const double t = static_cast<double>(cluster.steps) * s.dt, between = static_cast<double>(steps) * s.dt;
    for (std::size_t i = 0; i < s.beads.size(); ++i) {
      const Bead &then = cluster.start.beads[i], &now = s.beads[i];
      const Vec3 flown = centre_of(then) + t * (velocity(then) + 0.5 * t * s.gravity);
      fastest[i] = std::max(fastest[i], (velocity(now) - velocity(then) - t * s.gravity).norm());
      cluster.stray[i] =
          std::max(cluster.stray[i], 1.05 * ((centre_of(now) - flown).norm() + between * fastest[i]));
    }
  };
  try {
    while (cluster.steps < most) {
      advance(every);
      if (!apart(s)) continue;
      // Half of the impulse of the step in which a contact ends belongs to the next step. Without it, elastic
      // beads gained energy at every cluster whose last contact ended just before it was looked at.
      advance(1);
      if (apart(s)) return s;
    }
  } catch (const RunError&) {
    // Overlap too deep: the caller then advances all beads by steps, which report the error.
  }
  return std::nullopt;
}

}  // namespace twincell::sim
