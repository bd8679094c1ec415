#pragma once
/// \file
/// Numbers of a scene whose unit is in doubt.

#include <string>
#include <vector>

#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// One sentence for each number of a scene that most likely has a wrong unit (implausible_numbers): a
/// coefficient of friction in percent, a radius of one diameter, a gravity of 9.81 g. Also one for a gravity
/// in units of scale.gravity_m_s2.
std::vector<std::string> doubtful_units(const Scene& scene);

}  // namespace twincell::sim
