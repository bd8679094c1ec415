#include "sim/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sim/contact/contact.hpp"
#include "sim/kernels/kernels.hpp"
#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

std::string word_of(Effect::State state) {
  switch (state) {
    case Effect::State::on:
      return "on";
    case Effect::State::off_by_scene:
      return "off (scene)";
    case Effect::State::off_by_proof:
      return "off (proven)";
    case Effect::State::approximated:
      break;
  }
  return "approximated";
}

const TimeLimit& Plan::shortest() const {
  return *std::min_element(limits.begin(), limits.end(),
                           [](const TimeLimit& a, const TimeLimit& b) { return a.time < b.time; });
}

std::size_t remembered_numbers(const Plan& plan) {
  return static_cast<std::size_t>(kScalar.find(plan.key).remembered);
}

std::string Plan::law_names() const {
  std::string name = fmt::format("{}D; normal: {}; tangential: {}", dimension, law_name(laws->bead.normal),
                                 law_name(laws->bead.tangential));
  if (resists_rolling(laws->bead)) name += "; rolling: " + law_name(laws->bead.rolling);
  if (key.velocity == Velocity::full_step) name += "; predicted velocities";
  if (locate) name += "; steps split at entry and exit";
  return name;
}

System make_system(const Scene& s, const Plan& plan) {
  System system;
  system.dimension = s.dimension;
  system.period = s.period();
  system.gravity = s.gravity;
  system.walls = plan.walls;
  system.plate_drag = s.plate_drag;
  system.drive = s.drive;
  system.steps_per_period = plan.steps_per_period;
  system.dt = plan.dt;
  return system;
}

std::vector<double> contact_constants(const ContactLaws& laws, const PairScale& pair, double reach,
                                      double inv_radius_i, double inv_radius_j) {
  std::vector<double> set = {
      reach,         reach * reach * (1 + 1e-14), 1 / reach, 1 / (reach * reach), inv_radius_i, inv_radius_j,
      1 / pair.m_eff};
  const auto append = [&](const auto& axis) {
    std::visit(
        [&](const auto& law) {
          const auto own = law.constants(pair);
          set.insert(set.end(), own.begin(), own.end());
        },
        axis);
  };
  append(laws.normal);
  append(laws.tangential);
  append(laws.rolling);
  return set;
}

}  // namespace twincell::sim
