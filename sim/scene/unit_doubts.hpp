#pragma once
/// \file
/// Numbers of a scene whose unit is in doubt.

#include <string>
#include <vector>

#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// One sentence for each number of a scene with a scale that most likely has a wrong unit
/// (implausible_numbers), and for a gravity in units of scale.gravity_m_s2.
std::vector<std::string> doubtful_units(const Scene& scene);

}  // namespace twincell::sim
