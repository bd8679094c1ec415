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

struct SimulateOptions {
  std::string scene, output;
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
                      {"list_builds", run.list_builds()},
                      {"seconds", seconds},
                      {"particle_steps_per_second", seconds > 0 ? steps * n / seconds : 0}};
  for (const sim::Effect& e : run.plan().effects)
    d["effects"].push_back({{"name", e.name}, {"state", word_of(e.state)}, {"reason", e.reason}});
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
  const auto& settled = d["settled"];
  s += fmt::format("settled in {:.4g} t0 to {:.3g} m g sigma a bead{}\n", settled["time"].get<double>(),
                   settled["energy_per_bead"].get<double>(),
                   settled["reached"].get<bool>() ? "" : " (stopped by start.settle_limit)");
  for (const auto& e : d["effects"])
    s += fmt::format("  {:<20} {:<13} {}\n", e["name"].get<std::string>(), e["state"].get<std::string>(),
                     e["reason"].get<std::string>());
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
  if (common.seed) assignments.push_back(fmt::format("start.seed={}", *common.seed));
  sim::Scene scene = sim::read_scene(options.scene, assignments);
  Provenance provenance = common.provenance();
  provenance.inputs = {options.scene};
  if (!scene.from.empty()) provenance.inputs.push_back(scene.from);
  provenance.config = scene.resolved;
  provenance.seed = scene.seed;
  provenance.threads = std::max(1, common.threads);
  { const AtomicPath probe(options.output); }  // an unwritable place is found before the work, not after

  ProgressBar settling(common, "settling");
  sim::Simulation run(std::move(scene), settling, sim::KernelKind::best, common.threads);
  if (!run.settled().reached && run.scene().settle_limit > 0 && !run.system().beads.empty())
    note(common,
         fmt::format(
             "the bed still moved at {:.3g} m g sigma a bead when start.settle_limit ended its settling.",
             run.settled().energy_per_bead));
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
  const nlohmann::json document = describe(run, options.output, seconds);
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
  verb.callback([options, &common] { run_simulate(*options, common); });
}

}  // namespace twincell::cli
