// twincell explain SCENE.toml: the plan of a scene and its cost.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/output.hpp"
#include "cli/scene_notes.hpp"
#include "cli/verb.hpp"
#include "sim/accuracy/plan_json.hpp"
#include "sim/accuracy/step_error.hpp"
#include "sim/run/cost.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"
#include "sim/start/start.hpp"

namespace twincell::cli {

namespace {

struct ExplainOptions {
  std::string scene;
  std::vector<std::string> assignments;
};

constexpr double kMeasuredSeconds = 0.3;

std::string list_of(const sim::Plan& plan, sim::Effect::State state, const std::string& heading) {
  std::string s;
  for (const sim::Effect& e : plan.effects)
    if (e.state == state) s += fmt::format("  {:<22} {}\n", e.name, e.reason);
  return heading + "\n" + (s.empty() ? "  nothing\n" : s);
}

std::string duration(double seconds) {
  if (seconds < 120) return fmt::format("{:.2g} s", seconds);
  if (seconds < 7200) return fmt::format("{:.2g} min", seconds / 60);
  if (seconds < 172'800) return fmt::format("{:.2g} h", seconds / 3600);
  return fmt::format("{:.3g} d", seconds / 86'400);
}

/// Whether the run depends on the seed.
std::string chance_of(const sim::Scene& scene) {
  return sim::has_chance(scene)
             ? "the start is drawn at random: another start.seed gives another run"
             : "none: nothing in the start is drawn at random, and every start.seed gives the same run";
}

std::string as_text(const sim::Plan& plan, const sim::Scene& scene, const sim::Cost& cost) {
  using State = sim::Effect::State;
  std::string s = list_of(plan, State::on, "On, set by the scene") +
                  list_of(plan, State::off_by_scene, "Off, set by the scene") +
                  list_of(plan, State::off_by_proof, "Off, because the effect provably cannot act") +
                  list_of(plan, State::approximated, "Approximated, with a known error");
  if (!plan.warnings.empty()) s += "Warnings\n";
  for (const std::string& warning : plan.warnings) s += "  " + warning + "\n";
  const sim::StartRow& start = sim::start_row(scene.start);
  s += fmt::format("Start\n  {}: {}\n", start.word, start.help);
  s += fmt::format("Randomness\n  {}\n", chance_of(scene));
  s += fmt::format("Solver\n  {}; {}\n", plan.law_names(), cost.solver);
  s += fmt::format("  {:.0f} bytes per bead", cost.bytes_per_bead);
  if (cost.bytes_per_pair > 0)
    s += fmt::format(", {:.0f} bytes per listed pair, {:.3g} listed pairs per bead", cost.bytes_per_pair,
                     cost.pairs_per_bead);
  const sim::ResourceDemand demand = sim::resource_demand(scene, plan, cost.beads);
  s += fmt::format(
      "\nMachine\n"
      "  memory: about {} of {} available; frames written by `simulate`: at least {}",
      sim::bytes_text(demand.memory), sim::bytes_text(memory_available()), sim::bytes_text(demand.disk));
  s += fmt::format("\nSteps\n  {} per period{}, dt = {:.6e} t0, set by {}: {:.4e} t0 divided by {:g}\n",
                   plan.steps_per_period,
                   scene.drive.ramp && scene.drive.ramp->changes_frequency() ? " before the ramp" : "",
                   plan.dt, plan.shortest().name, plan.shortest().time, scene.steps_per_contact);
  const double steps = static_cast<double>(plan.steps), beads = static_cast<double>(cost.beads);
  s += fmt::format("  {} beads x {} periods = {:.3g} particle-steps, without settling\n", cost.beads,
                   plan.cycles_before + scene.cycles, steps * beads);
  if (!cost.stopped.empty()) return s + "Time\n  unknown: the short test run stopped: " + cost.stopped + "\n";
  s += fmt::format("Time\n  {}, at {:.3g} million particle-steps/s; ",
                   duration(steps * cost.seconds_per_step), 1e-6 * beads / cost.seconds_per_step);
  s += cost.relative_work
           ? fmt::format(
                 "the bed at rest was measured on this machine; a step of the driven bed takes {:.2g} of "
                 "its time on average\n",
                 *cost.relative_work)
           : fmt::format("measured on this machine over {} steps of this scene after {:.3g} t0 of settling\n",
                         cost.measured_steps, cost.settled_for);
  s += fmt::format("  the time in which `simulate` writes {:.0f} frames comes on top of this\n",
                   demand.frames);
  return s;
}

void run(const ExplainOptions& o, const Common& common) {
  const sim::Scene scene = sim::read_scene(o.scene, with_seed(o.assignments, common));
  for (const sim::VoidKey& key : scene.void_keys) note(common, key.text());
  note_units(common, scene);
  ProgressBar bar(common, "placing beads");
  const sim::Cost cost = sim::measure_cost(scene, kMeasuredSeconds, common.threads, bar);
  sim::Plan plan = cost.plan;
  sim::state_step_error(scene, plan, cost.start_speeds);
  const nlohmann::json d = nlohmann::json::parse(sim::cost_json(scene, cost));
  print_result(common, d, as_text(plan, scene, cost));
}

}  // namespace

void add_explain(CLI::App& program, Common& common) {
  auto o = std::make_shared<ExplainOptions>();
  CLI::App& verb = add_verb(program, common, "explain",
                            "Show the plan of a scene: effects that are on, off or approximated, with "
                            "reasons; time step, memory and expected time. Runs the scene for at most a few "
                            "seconds to measure its speed, and writes no file.",
                            "twincell explain scene.toml --set contact.mu=0.0");
  takes_seed(verb, common);
  verb.add_option("scene", o->scene, "Scene file (TOML, docs/scene.md)")->required();
  verb.add_option("--set", o->assignments,
                  "Set a key of the scene, as section.key=value; overrides the file; may be repeated")
      ->take_all();
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
