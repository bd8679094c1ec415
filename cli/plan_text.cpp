#include "cli/plan_text.hpp"

#include "cli/output.hpp"
#include "sim/accuracy/plan_json.hpp"

namespace twincell::cli {

nlohmann::json plan_as_json(const sim::Plan& plan) {
  return nlohmann::json::parse(sim::plan_json(plan));
}

std::string scene_provenance(const Common& common, const sim::Scene& scene,
                             const std::vector<sim::Bead>& beads, std::vector<std::filesystem::path> inputs) {
  Provenance provenance = common.provenance();
  provenance.inputs = std::move(inputs);
  return sim::scene_provenance(std::move(provenance), scene, beads, common.threads);
}

}  // namespace twincell::cli
