#pragma once
/// \file
/// Notes on a scene that all verbs print which read one.

#include "cli/output.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::cli {

/// Notes the numbers of a scene with a scale that most likely have a wrong unit (sim::doubtful_units).
void note_units(const Common& common, const sim::Scene& scene);

}  // namespace twincell::cli
