#pragma once
/// \file
/// The plan of a scene, its cost and its provenance as JSON, as all front ends state them.

#include <string>
#include <vector>

#include "core/provenance.hpp"
#include "sim/run/cost.hpp"
#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// {"kernel", "steps_per_period", "dt", "dt_set_by", "steps", "effects": [{"name", "state", "reason"}],
/// "time_limits": [{"name", "time"}], "warnings"}. Times in t0.
std::string plan_json(const Plan& plan);

/// What `explain` states: plan_json with the error of the step (state_step_error), and "beads", "has_chance",
/// "start", "vectors", "bytes_per_bead", "bytes_per_pair", "pairs_per_bead", "expected_memory_bytes",
/// "expected_disk_bytes", "particle_steps"; then "expected_seconds", "particle_steps_per_second" and
/// "measured_steps", "relative_work" if a whole period was not measured (Cost), or "stopped" if the
/// measurement ended early.
std::string cost_json(const Scene& scene, const Cost& cost);

/// The provenance of a run of a scene.
/// \param provenance with command line and inputs
/// \param threads asked for; 0: chosen
/// \throws InputError if an input cannot be read
std::string scene_provenance(Provenance provenance, const Scene& scene, const std::vector<Bead>& beads,
                             int threads);

}  // namespace twincell::sim
