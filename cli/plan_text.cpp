#include "cli/plan_text.hpp"

namespace twincell::cli {

nlohmann::json as_json(const sim::Plan& plan) {
  nlohmann::json d = {{"kernel", plan.kernel_name()},
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

}  // namespace twincell::cli
