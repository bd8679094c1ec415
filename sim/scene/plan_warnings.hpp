#pragma once
/// \file
/// Warnings about settings of a scene that run but may not be intended.

#include <string>
#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// One sentence per warning. Requires the laws, limits and steps of the plan.
std::vector<std::string> warnings_of(const Scene& scene, const Plan& plan);

}  // namespace twincell::sim
