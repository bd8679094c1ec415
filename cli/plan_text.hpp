#pragma once
/// \file
/// What a simulation says of itself, for results and provenance: its plan, in the plan's own words, and its
/// origin.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::cli {

struct Common;

/// Solver, steps, and every effect with its state and reason.
nlohmann::json as_json(const sim::Plan& plan);

/// Provenance of a simulated file. \param beads as placed: a file's may set another step than the scene's
std::string scene_provenance(const Common& common, const sim::Scene& scene,
                             const std::vector<sim::Bead>& beads, std::vector<std::filesystem::path> inputs);

}  // namespace twincell::cli
