#pragma once
/// \file
/// Derives the plan of a run from its scene.

#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// Derives the plan. mu = 0 turns off friction, rotation and history, because they then have no influence.
/// \param beads whose sizes and masses set the step and the bounds; if empty, the sizes that the scene states
/// \throws ConfigError for parameters that a law needs or refuses, for steps that are too long or too many,
/// and for an effect that the scene turns off although it has an influence
Plan make_plan(const Scene& scene, const std::vector<Bead>& beads = {});

}  // namespace twincell::sim
