#pragma once
/// \file
/// Clusters: a few beads of a dilute gas of which at least three are in contact. A cluster is advanced
/// separately, by time steps, until all its beads have parted.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Beads extracted from a System at a whole step.
struct Cluster {
  std::vector<std::int32_t> members;    ///< indices in the whole system, increasing
  System start;                         ///< a system of the members only, with their forces
  std::vector<ContactMemory> memories;  ///< contacts among members, indexed as in `start`
  std::int64_t steps = 0;               ///< number of steps after which all have parted
  std::vector<double> stray;            ///< largest deviation of each from free flight until then, sigma
};

/// Extracts `members` from `whole`. No other bead may touch them.
Cluster take_out(const System& whole, const std::vector<ContactMemory>& memories,
                 std::vector<std::int32_t> members);

/// State of a cluster some steps after its start, with its contact memories.
struct ClusterState {
  System system;
  std::vector<ContactMemory> memories;
};
/// Advances a copy of a cluster by a number of steps from its start, without other beads.
/// \param make_solver makes the solver for a system of the members
ClusterState after(const Cluster& cluster, std::int64_t steps,
                   const std::function<std::unique_ptr<Solver>()>& make_solver);

/// Advances a cluster until no member touches another or a wall; sets `steps` and `stray`. The state is
/// checked at intervals of an eighth of `contact` steps.
/// \param contact number of steps of the shortest contact
/// \param most largest number of steps
/// \returns the final state; nothing if the beads have not parted after `most` steps or overlap too deeply
std::optional<System> separate_cluster(Cluster& cluster, std::int64_t contact, std::int64_t most,
                                       const std::function<std::unique_ptr<Solver>()>& make_solver);

}  // namespace twincell::sim
