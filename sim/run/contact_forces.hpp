#pragma once
/// \file
/// Forces at the contacts of a system at one instant.

#include <cstdint>
#include <utility>
#include <vector>

#include "sim/scene/plan.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Pairs of beads that may touch, kept between calls of contact_forces for one system that moves on. The
/// contacts that it finds do not depend on what it kept.
class NearPairs {
 public:
  /// Pairs i < j that include all beads in contact; searched again if beads have moved relative to the bed by
  /// more than half of the margin with which they were searched.
  const std::vector<std::pair<std::int32_t, std::int32_t>>& of(const System& s);

 private:
  [[nodiscard]] bool cover(const System& s) const;

  std::vector<std::pair<std::int32_t, std::int32_t>> pairs_;
  std::vector<Vec3> at_;  ///< centres at the search
  double margin_ = 0;     ///< sigma
};

/// The force of every contact of a system: the contact laws at its present positions and velocities, with the
/// springs and other memories of the contacts as they are. Sorted by (i, j). It is the force of the equation
/// of motion at this instant. A solver uses it with corrections of the order of the time step: the mean over
/// the fraction of a step during which a contact exists, and velocities predicted from the middle of the step
/// (contact.hpp).
/// \param memories Solver::contacts()
/// \param near of the same system at earlier calls
std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories, NearPairs& near);
std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories);

}  // namespace twincell::sim
