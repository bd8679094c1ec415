#pragma once
/// \file
/// Forces at the contacts of a system at one instant.

#include <vector>

#include "sim/scene/plan.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// The force of every contact of a system: the contact laws at its present positions and velocities, with the
/// springs and other memories of the contacts as they are. Sorted by (i, j). It is the force of the equation
/// of motion at this instant. A solver uses it with corrections of the order of the time step: the mean over
/// the fraction of a step during which a contact exists, and velocities predicted from the middle of the step
/// (contact.hpp).
/// \param memories Solver::contacts()
std::vector<ContactForce> contact_forces(const Plan& plan, const System& system,
                                         const std::vector<ContactMemory>& memories);

}  // namespace twincell::sim
