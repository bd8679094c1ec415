#include "sim/scene/make_plan.hpp"

#include <cmath>

#include "sim/laws/cell_laws.hpp"
#include "sim/laws/law_words.hpp"
#include "sim/scene/drive_tables.hpp"
#include "sim/scene/plan_effects.hpp"
#include "sim/scene/plan_stepping.hpp"
#include "sim/scene/plan_time_step.hpp"
#include "sim/scene/plan_warnings.hpp"
#include "sim/scene/recorded_drive.hpp"

namespace twincell::sim {

namespace {

/// The words of the laws: those of the scene, reduced to what has an influence.
ContactChoice reduced_laws(const ContactChoice& asked, const std::vector<Wall>& walls) {
  std::vector<const ContactTable*> tables = {&asked.bead};
  for (const Wall& w : walls) tables.push_back(&asked.wall.at(w.name));
  bool frictional = false, springy = false;
  for (const ContactTable* t : tables) {
    if (read_friction(*t) <= 0) continue;
    frictional = true;
    springy = springy || !tangential_reads(asked.tangential, "k_t") || read_tangential_stiffness(*t) != 0;
  }
  // All kinds of contact share the laws. If one has friction, friction is computed for all; where mu = 0 the
  // force is exactly 0.
  ContactChoice reduced = asked;
  if (!frictional) reduced.tangential = NoTangential::kWord;
  if (!springy) reduced.tangential = law_without_history(reduced.tangential);
  if (reduced.tangential == NoTangential::kWord) reduced.rolling = NoRolling::kWord;
  return reduced;
}

ContactLaws read_laws(const ContactChoice& words, const ContactTable& table) {
  return {read_law<NormalAxis>(words.normal, table), read_law<TangentialAxis>(words.tangential, table),
          read_law<RollingAxis>(words.rolling, table)};
}

void set_laws(const Scene& s, Plan& plan) {
  const ContactChoice words = reduced_laws(s.contact, plan.walls);
  CellLaws laws{.bead = read_laws(words, s.contact.bead), .walls = {}};
  for (const Wall& w : plan.walls) laws.walls.push_back(read_laws(words, s.contact.wall.at(w.name)));
  plan.key = {s.dimension, laws.bead.normal.index(), laws.bead.tangential.index(), laws.bead.rolling.index(),
              integrator_named(s.integrator).velocity};
  plan.locate = integrator_named(s.integrator).locate;
  plan.rotation = std::visit([](const auto& law) { return law.kActs; }, laws.bead.tangential);
  plan.history = std::visit([](const auto& law) { return law.kHistory; }, laws.bead.tangential);
  plan.stores_memory = s.springs.value_or(s.contacts && remembered_numbers(plan) > 0);
  plan.laws = std::make_shared<const CellLaws>(std::move(laws));
}

/// Number of cycles: a schedule of the amplitude precedes the cycles that are discarded.
void set_cycles(const Scene& s, Plan& plan) {
  plan.cycles_before = cycles_before(s.envelope, s.discard);
  const std::int64_t cycles = plan.cycles_before + s.cycles;
  plan.steps = cycles * plan.steps_per_period;
  if (s.drive.ramp && s.drive.ramp->changes_frequency())
    plan.steps = std::llround(s.drive.time_at(static_cast<double>(cycles)) / plan.dt);
  require_record_lasts(s.drive, cycles, s.where("drive.file"));
}

}  // namespace

Plan make_plan(const Scene& s, const std::vector<Bead>& beads) {
  Plan plan;
  plan.dimension = s.dimension;
  plan.walls = s.walls();
  set_laws(s, plan);
  refuse_effects(s, plan);
  set_time_step(s, beads, plan);
  set_cycles(s, plan);
  plan.effects = list_effects(s, plan);
  choose_stepping(s, beads.empty() ? s.n_beads.value_or(0) : beads.size(), plan);
  plan.warnings = warnings_of(s, plan);
  return plan;
}

}  // namespace twincell::sim
