#pragma once
/// \file
/// A few beads of a dilute gas that meet in threes: moved by time steps, by themselves, until all have
/// parted.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Beads taken out of a System at a whole step.
struct Cluster {
  std::vector<std::int32_t> members;    ///< their places in the whole, rising
  System start;                         ///< they alone; forces and
  std::vector<ContactMemory> memories;  ///< memories of the contacts among them, by place in `start`
  std::int64_t steps = 0;               ///< after which all have parted
  std::vector<double> stray;            ///< how far each gets from free flight until then, sigma
};

/// Takes members, which no other bead touches, out of `whole`.
Cluster take_out(const System& whole, const std::vector<ContactMemory>& memories,
                 std::vector<std::int32_t> members);

/// A cluster some steps after its start, and what its contacts remember.
struct ClusterState {
  System system;
  std::vector<ContactMemory> memories;
};
ClusterState after(const Cluster& cluster, std::int64_t steps,
                   const std::function<std::unique_ptr<Solver>()>& kernel);

/// Moves a cluster until none of it touches another or a wall; sets steps and stray. They are looked at every
/// few steps, an eighth of `contact`. \param contact steps of the shortest contact \param most steps
/// \returns the state then; none if they have not parted, or overlap too much
std::optional<System> disperse(Cluster& cluster, std::int64_t contact, std::int64_t most,
                               const std::function<std::unique_ptr<Solver>()>& kernel);

}  // namespace twincell::sim
