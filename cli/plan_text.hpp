#pragma once
/// \file
/// The plan and the origin of a simulation, for results and provenance.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/scene/plan.hpp"

namespace twincell::cli {

struct Common;

/// The plan as JSON: kernel, time step, and every effect with its state and reason.
nlohmann::json plan_as_json(const sim::Plan& plan);

/// Provenance of a simulated file.
/// \param beads the placed beads; beads that are read from a file can require another step than the scene
/// alone
std::string scene_provenance(const Common& common, const sim::Scene& scene,
                             const std::vector<sim::Bead>& beads, std::vector<std::filesystem::path> inputs);

}  // namespace twincell::cli
