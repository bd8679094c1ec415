#include "sim/accuracy/plan_json.hpp"

#include "core/json_text.hpp"
#include "sim/accuracy/step_error.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/resource_demand.hpp"
#include "sim/scene/starts.hpp"
#include "sim/start/start.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

namespace {

nlohmann::json as_json(const Plan& plan) {
  nlohmann::json d = {{"kernel", plan.law_names()},
                      {"steps_per_period", plan.steps_per_period},
                      {"dt", plan.dt},
                      {"dt_set_by", plan.shortest().name},
                      {"steps", plan.steps}};
  for (const Effect& e : plan.effects)
    d["effects"].push_back({{"name", e.name}, {"state", word_of(e.state)}, {"reason", e.reason}});
  for (const TimeLimit& l : plan.limits) d["time_limits"].push_back({{"name", l.name}, {"time", l.time}});
  if (!plan.warnings.empty()) d["warnings"] = plan.warnings;
  return d;
}

}  // namespace

std::string plan_json(const Plan& plan) {
  return json_text(as_json(plan));
}

std::string cost_json(const Scene& scene, const Cost& cost) {
  Plan plan = cost.plan;
  state_step_error(scene, plan, cost.start_speeds);
  nlohmann::json d = as_json(plan);
  const double beads = static_cast<double>(cost.beads);
  d["beads"] = cost.beads;
  d["start"] = start_row(scene.start).word;
  d["has_chance"] = has_chance(scene);
  d["vectors"] = cost.solver;
  d["bytes_per_bead"] = cost.bytes_per_bead;
  d["bytes_per_pair"] = cost.bytes_per_pair > 0 ? nlohmann::json(cost.bytes_per_pair) : nlohmann::json();
  d["pairs_per_bead"] = cost.pairs_per_bead;
  const ResourceDemand demand = resource_demand(scene, plan, cost.beads);
  d["expected_memory_bytes"] = demand.memory;
  d["expected_disk_bytes"] = demand.disk;
  d["particle_steps"] = beads * static_cast<double>(plan.steps);
  if (cost.stopped.empty()) {
    d["expected_seconds"] = cost.seconds_per_step * static_cast<double>(plan.steps);
    d["particle_steps_per_second"] = beads / cost.seconds_per_step;
    d["measured_steps"] = cost.measured_steps;
    if (cost.relative_work) d["relative_work"] = *cost.relative_work;
  } else {
    d["stopped"] = cost.stopped;
  }
  return json_text(d);
}

std::string scene_provenance(Provenance provenance, const Scene& scene, const std::vector<Bead>& beads,
                             int threads) {
  if (!scene.from.empty()) provenance.inputs.push_back(scene.from);
  if (!scene.record.file.empty()) provenance.inputs.push_back(scene.record.file);
  provenance.config = scene.resolved;
  Plan plan = make_plan(scene, beads);
  state_step_error(scene, plan, speeds_of_start(scene, beads));
  provenance.plan = plan_json(plan);
  provenance.seed = scene.seed;
  provenance.threads = threads_for(scene.n_beads.value_or(0), threads);
  return provenance.to_json();
}

}  // namespace twincell::sim
