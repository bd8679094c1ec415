#pragma once
/// \file
/// Notes on a scene that all verbs print which read one.

#include <string>
#include <vector>

#include "cli/output.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::cli {

/// Notes the numbers of a scene with a scale that most likely have a wrong unit (sim::doubtful_units).
void note_units(const Common& common, const sim::Scene& scene);

/// Notes a seed of the command line if nothing in the start is drawn at random (sim::has_chance).
///
/// \param assignments of the command line, that of --seed included (with_seed)
void note_seed(const Common& common, const sim::Scene& scene, const std::vector<std::string>& assignments);

}  // namespace twincell::cli
