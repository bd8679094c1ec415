// twincell simulate SCENE.toml -o sim.h5

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>

#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "sim/simulation.hpp"

namespace twincell::cli {

namespace {

/// Share of their time in contact up to which beads are as good as hard.
constexpr double kHardBeads = 0.1;

struct SimulateOptions {
  std::string scene, output;
  bool relax = false;
  std::vector<std::string> assignments;
};

const char* word_of(sim::Effect::State state) {
  switch (state) {
    case sim::Effect::State::on:
      return "on";
    case sim::Effect::State::off_by_scene:
      return "off (scene)";
    case sim::Effect::State::off_by_proof:
      return "off (proven)";
    case sim::Effect::State::approximated:
      break;
  }
  return "approximated";
}

/// What the bed grew from: near a transition the same drive keeps different beds for hundreds of cycles.
nlohmann::json start_of(const sim::Scene& s) {
  static constexpr const char* kKinds[] = {"crystal_a", "crystal_b", "random", "trajectory", "table"};
  nlohmann::json start = {{"kind", kKinds[static_cast<int>(s.start)]},
                          {"seed", s.seed},
                          {"perturbation", s.perturbation},
                          {"drive", !s.envelope.points.empty() ? "ramp or schedule"
                                    : s.comoving               ? "comoving"
                                                               : "abrupt"}};
  if (!s.from.empty()) start["from"] = s.from.string();
  return start;
}

nlohmann::json describe(const sim::Simulation& run, const std::string& output, double seconds) {
  const sim::Scene& s = run.scene();
  const double steps = static_cast<double>(run.steps_done()),
               n = static_cast<double>(run.system().beads.size());
  nlohmann::json d = {{"output", output},
                      {"beads", run.system().beads.size()},
                      {"gamma", s.g() > 0 ? nlohmann::json(s.drive.gamma(s.g())) : nlohmann::json()},
                      {"k_m", s.g() > 0 ? nlohmann::json(s.drive.k_m(s.g())) : nlohmann::json()},
                      {"amplitude", s.drive.amplitude},
                      {"omega", s.drive.omega},
                      {"steps_per_period", run.plan().steps_per_period},
                      {"dt", run.plan().dt},
                      {"cycles", s.cycles},
                      {"discarded", s.discard},
                      {"kernel", run.plan().kernel_name()},
                      {"settled",
                       {{"time", run.settled().time},
                        {"energy_per_bead", run.settled().energy_per_bead},
                        {"reached", run.settled().reached}}},
                      {"start", start_of(s)},
                      {"list_builds", run.list_builds()},
                      {"seconds", seconds},
                      {"particle_steps_per_second", seconds > 0 ? steps * n / seconds : 0}};
  for (const sim::Effect& e : run.plan().effects)
    d["effects"].push_back({{"name", e.name}, {"state", word_of(e.state)}, {"reason", e.reason}});
  if (const auto fraction = run.contact_fraction()) d["contact_fraction"] = *fraction;
  for (const sim::TimeLimit& l : run.plan().limits)
    d["time_limits"].push_back({{"name", l.name}, {"time", l.time}});
  return d;
}

std::string as_text(const nlohmann::json& d) {
  std::string s = fmt::format("{} beads, {}\n", d["beads"].get<long>(), d["kernel"].get<std::string>());
  if (d["gamma"].is_number())
    s += fmt::format("Gamma = {:.6g}, K_m = {:.6g}\n", d["gamma"].get<double>(), d["k_m"].get<double>());
  s += fmt::format("{} steps a period, dt = {:.6e} t0\n", d["steps_per_period"].get<long>(),
                   d["dt"].get<double>());
  const auto& start = d["start"];
  s += fmt::format("start: {}, seed {}, drive {}\n", start["kind"].get<std::string>(),
                   start["seed"].get<long>(), start["drive"].get<std::string>());
  const auto& settled = d["settled"];
  s += fmt::format("settled in {:.4g} t0 to {:.3g} m g sigma a bead{}\n", settled["time"].get<double>(),
                   settled["energy_per_bead"].get<double>(),
                   settled["reached"].get<bool>() ? "" : " (stopped by start.settle_limit)");
  for (const auto& e : d["effects"])
    s += fmt::format("  {:<20} {:<13} {}\n", e["name"].get<std::string>(), e["state"].get<std::string>(),
                     e["reason"].get<std::string>());
  if (d.contains("contact_fraction"))
    s += fmt::format("beads touch something {:.3g} of the time{}\n", d["contact_fraction"].get<double>(),
                     d["contact_fraction"].get<double>() > kHardBeads
                         ? "; theories of hard beads, which meet for no time, do not hold above 0.1"
                         : "");
  s +=
      fmt::format("{} cycles after {} discarded, {:.3g} s, {:.3g} million particle-steps/s, {} lists built\n",
                  d["cycles"].get<long>(), d["discarded"].get<long>(), d["seconds"].get<double>(),
                  1e-6 * d["particle_steps_per_second"].get<double>(), d["list_builds"].get<long>());
  return s + d["output"].get<std::string>() + "\n";
}

std::string failed_name(const std::string& output) {
  std::filesystem::path path(output);
  return path.replace_extension(".failed" + path.extension().string()).string();
}

void run_simulate(const SimulateOptions& options, const Common& common) {
  std::vector<std::string> assignments = options.assignments;
  if (options.relax) assignments.push_back("start.relax=true");
  if (common.seed) assignments.push_back(fmt::format("start.seed={}", *common.seed));
  sim::Scene scene = sim::read_scene(options.scene, assignments);
  Provenance provenance = common.provenance();
  provenance.inputs = {options.scene};
  if (!scene.from.empty()) provenance.inputs.push_back(scene.from);
  provenance.config = scene.resolved;
  provenance.seed = scene.seed;
  provenance.threads = std::max(1, common.threads);
  { const AtomicPath probe(options.output); }  // an unwritable place is found before the work, not after

  const std::vector<std::string> told = sim::make_plan(scene).warnings;  // settling may take long
  for (const std::string& warning : told) note(common, warning);
  ProgressBar settling(common, "settling");
  sim::Simulation run(std::move(scene), settling, sim::KernelKind::best, common.threads);
  const std::vector<std::string> warnings = run.warnings();
  for (const std::string& warning : warnings)
    if (std::find(told.begin(), told.end(), warning) == told.end()) note(common, warning);
  TrajectoryInfo info = run.trajectory_info();
  info.provenance_json = provenance.to_json();
  H5mdWriter writer(options.output, std::move(info));
  ProgressBar bar(common, "simulating");
  const auto begin = std::chrono::steady_clock::now();
  try {
    run.run(writer, bar);
  } catch (const RunError& e) {
    const std::string kept = failed_name(options.output);
    writer.finish_as(kept);
    throw RunError(std::string(e.what()) + " The frames up to there are in " + kept + ".");
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  writer.finish();
  nlohmann::json document = describe(run, options.output, seconds);
  document["warnings"] = warnings;
  print_result(common, document, as_text(document));
}

}  // namespace

void add_simulate(CLI::App& program, Common& common) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App& verb =
      add_verb(program, common, "simulate", "Run a scene",
               "twincell simulate scene.toml -o sim.h5 --set drive.gamma=1.8 --set time.cycles=50");
  verb.add_option("scene", options->scene, "Scene (TOML, docs/scene.md)")->required();
  verb.add_option("-o,--output", options->output, "Trajectory to write (H5MD)")->required();
  verb.add_option("--set", options->assignments, "section.key=value, over the scene's own; may be repeated")
      ->take_all();
  verb.add_flag("--relax", options->relax, "Push beads of the start apart, however deep they overlap");
  verb.callback([options, &common] { run_simulate(*options, common); });
}

}  // namespace twincell::cli
