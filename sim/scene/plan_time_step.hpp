#pragma once
/// \file
/// The limits of a plan: of the time step, from the shortest contacts, and of displacement per step, overlap
/// and force.

#include <cstdint>
#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// Sets the bounds of overlap, displacement and force, the limits of the time step, and the step: the
/// shortest limit divided by steps_per_contact, shortened so that each phase is a whole number of steps.
/// Requires the laws and walls of the plan.
/// \param beads as in make_plan.hpp
/// \throws ConfigError for a step below 1e-12 t0, more than 1e10 steps per cycle, or a plate that moves
/// beyond the displacement bound in one step
void set_time_step(const Scene& scene, const std::vector<Bead>& beads, Plan& plan);

}  // namespace twincell::sim
