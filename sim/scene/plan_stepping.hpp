#pragma once
/// \file
/// Whether a run moves from step to step or from contact to contact.

#include <cstddef>

#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// Selects event-driven motion where it is exact, and requested or likely to be faster, as in a dilute bed
/// with not too many beads, and adds the effect "free flight". Requires the laws and `history` of the plan.
/// \param beads their number
/// \throws ConfigError if the scene requests event-driven motion and the plan does not allow it
void choose_stepping(const Scene& scene, std::size_t beads, Plan& plan);

}  // namespace twincell::sim
