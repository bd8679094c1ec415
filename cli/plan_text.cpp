#include "cli/plan_text.hpp"

#include "cli/output.hpp"
#include "core/json_text.hpp"
#include "sim/accuracy/step_error.hpp"
#include "sim/run/simulation.hpp"

namespace twincell::cli {

nlohmann::json as_json(const sim::Plan& plan) {
  nlohmann::json d = {{"kernel", plan.law_names()},
                      {"steps_per_period", plan.steps_per_period},
                      {"dt", plan.dt},
                      {"dt_set_by", plan.shortest().name},
                      {"steps", plan.steps}};
  for (const sim::Effect& e : plan.effects)
    d["effects"].push_back({{"name", e.name}, {"state", sim::word_of(e.state)}, {"reason", e.reason}});
  for (const sim::TimeLimit& l : plan.limits)
    d["time_limits"].push_back({{"name", l.name}, {"time", l.time}});
  if (!plan.warnings.empty()) d["warnings"] = plan.warnings;
  return d;
}

std::string scene_provenance(const Common& common, const sim::Scene& scene,
                             const std::vector<sim::Bead>& beads, std::vector<std::filesystem::path> inputs) {
  Provenance provenance = common.provenance();
  provenance.inputs = std::move(inputs);
  if (!scene.from.empty()) provenance.inputs.push_back(scene.from);
  provenance.config = scene.resolved;
  sim::Plan plan = sim::make_plan(scene, beads);
  sim::state_step_error(scene, plan);
  provenance.plan = json_text(as_json(plan));
  provenance.seed = scene.seed;
  provenance.threads = sim::threads_for(scene.n_beads.value_or(0), common.threads);
  return provenance.to_json();
}

}  // namespace twincell::cli
