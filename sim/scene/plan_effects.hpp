#pragma once
/// \file
/// The effects of a plan: which are on, which are off, and why.

#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// The effects of a scene under a plan whose laws, walls, `rotation` and `history` are set, in the order in
/// which `explain` lists them. Free flight, which plan_stepping.hpp adds, is not among them.
std::vector<Effect> list_effects(const Scene& scene, const Plan& plan);

/// Refuses a scene that turns off an effect which has an influence, or that states one which has none.
/// \throws ConfigError
void refuse_effects(const Scene& scene, const Plan& plan);

}  // namespace twincell::sim
