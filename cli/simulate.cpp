// twincell simulate SCENE.toml -o sim.h5: runs a scene and writes its trajectory.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "cli/plan_text.hpp"
#include "cli/profile.hpp"
#include "cli/scene_notes.hpp"
#include "cli/verb.hpp"
#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"
#include "sim/accuracy/step_error.hpp"
#include "sim/run/checkpoint_folder.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

/// Largest fraction of time in contact up to which beads behave like hard beads.
constexpr double kHardBeads = 0.1;

struct SimulateOptions {
  std::string scene, output;
  bool relax = false, contacts = false;
  std::vector<std::string> assignments;
  std::optional<double> checkpoint_every;  ///< s; 0: only at signals
  bool resume = false;
  bool profile = false;
};

/// Shows the progress bar. Saves a checkpoint at regular intervals, and before a signal ends the program.
class SavingProgress : public Progress {
 public:
  SavingProgress(const Common& common, const std::string& label, const sim::Simulation& run,
                 sim::CheckpointFolder* folder, double seconds, StageTimes* times)
      : bar_(common, label), run_(run), folder_(folder), every_(seconds), times_(times) {
    if (folder != nullptr) finish_.emplace();  // a run can be saved only between steps
  }

  void update(std::int64_t done, std::int64_t total) override {
    if (folder_ == nullptr) return bar_.update(done, total);
    try {
      bar_.update(done, total);
    } catch (const Interrupted& e) {
      folder_->save(run_.state());
      throw Interrupted(e.exit_code(), "Stopped by a signal; the same command with --resume continues from " +
                                           folder_->path().string() + ".");
    }
    if (!(every_.count() > 0 && Clock::now() - saved_ >= every_)) return;
    {
      Stage saving(times_, "checkpoints", "checkpoints");
      folder_->save(run_.state());
      saving.count(1);
    }
    saved_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  ProgressBar bar_;
  const sim::Simulation& run_;
  sim::CheckpointFolder* folder_;
  std::chrono::duration<double> every_;
  StageTimes* times_;
  std::optional<FinishFirst> finish_;
  Clock::time_point saved_ = Clock::now();
};

/// How the drive begins.
const char* drive_at_start(const sim::Scene& s) {
  if (s.in_motion) return "goes on";
  if (!s.envelope.points.empty()) return "ramp or schedule";
  return s.comoving ? "comoving" : "abrupt";
}

/// The start of the bed, for the result. Near a transition, beds with the same drive but different starts can
/// differ for hundreds of cycles.
nlohmann::json start_of(const sim::Scene& s) {
  nlohmann::json start = {{"kind", sim::start_row(s.start).word},
                          {"seed", s.seed},
                          {"perturbation", s.perturbation},
                          {"in_motion", s.in_motion},
                          {"drive", drive_at_start(s)}};
  if (!s.from.empty()) start["from"] = s.from.string();
  return start;
}

/// The end of the ramp of the drive; null without one.
nlohmann::json ramp_of(const sim::Scene& s) {
  if (!s.drive.ramp) return {};
  const DriveLevel& to = s.drive.ramp->to;
  nlohmann::json ramp = {{"amplitude", to.amplitude},
                         {"omega", to.omega},
                         {"linear", s.drive.ramp->linear_quantity()},
                         {"returns", s.drive.ramp->returns}};
  if (s.g() > 0) ramp["gamma"] = to.amplitude * to.omega * to.omega / s.g();
  return ramp;
}

/// A run that has ended.
struct FinishedRun {
  const sim::Simulation& run;
  sim::Plan plan;  ///< with the error of its step
  std::string output;
  std::int64_t begun_at = 0;  ///< step of the drive; 0: at its beginning
  double seconds = 0;

  [[nodiscard]] double particle_steps_per_second() const {
    return seconds > 0 ? static_cast<double>(run.steps_done()) *
                             static_cast<double>(run.system().beads.size()) / seconds
                       : 0;
  }
};

nlohmann::json describe(const FinishedRun& ended) {
  const sim::Simulation& run = ended.run;
  const sim::Scene& s = run.scene();
  nlohmann::json d = {
      {"output", ended.output},
      {"beads", run.system().beads.size()},
      {"gamma", s.g() > 0 ? nlohmann::json(s.drive.gamma()) : nlohmann::json()},
      {"k_m", s.g() > 0 ? nlohmann::json(s.drive.k_m()) : nlohmann::json()},
      {"amplitude", s.drive.amplitude},
      {"omega", s.drive.omega},
      {"displacement", s.drive.formula()},
      {"ramp", ramp_of(s)},
      {"cycles", s.cycles},
      {"discarded", s.discard},
      {"continued_from_step", ended.begun_at > 0 ? nlohmann::json(ended.begun_at) : nlohmann::json()},
      {"settled",
       {{"time", run.settled().time},
        {"energy_per_bead", run.settled().energy_per_bead},
        {"reached", run.settled().reached}}},
      {"start", start_of(s)},
      {"list_builds", run.list_builds()},
      {"seconds", ended.seconds},
      {"particle_steps_per_second", ended.particle_steps_per_second()}};
  d.update(plan_as_json(ended.plan));
  if (const auto fraction = run.contact_fraction()) d["contact_fraction"] = *fraction;
  return d;
}

std::string as_text(const FinishedRun& ended, bool verbose) {
  const sim::Simulation& run = ended.run;
  const sim::Scene& scene = run.scene();
  const sim::Plan& plan = ended.plan;
  std::string s = fmt::format("{}, {}\n", plural(run.system().beads.size(), "bead"), plan.law_names());
  if (scene.g() > 0)
    s += fmt::format("Gamma = {:.6g}, K_m = {:.6g}{}, displacement {}\n", scene.drive.gamma(),
                     scene.drive.k_m(), scene.drive.ramp ? " before the ramp" : "", scene.drive.formula());
  if (scene.g() > 0 && scene.drive.ramp) {
    const DriveLevel& to = scene.drive.ramp->to;
    s += fmt::format("Gamma = {:.6g} at the {} of the ramp, {} linear in time\n",
                     to.amplitude * to.omega * to.omega / scene.g(),
                     scene.drive.ramp->returns ? "turn" : "end", scene.drive.ramp->linear_quantity());
  }
  s += fmt::format("{} steps per period, dt = {:.6e} t0\n", plan.steps_per_period, plan.dt);
  s += fmt::format("start: {}, seed {}, drive {}\n", sim::start_row(scene.start).word, scene.seed,
                   drive_at_start(scene));
  if (scene.in_motion)
    s += "no settling: the start is in motion\n";
  else
    s += fmt::format("settled in {:.4g} t0 to {:.3g} m g sigma per bead{}\n", run.settled().time,
                     run.settled().energy_per_bead,
                     run.settled().reached ? "" : " (stopped by start.settle_limit)");
  if (verbose)
    for (const sim::Effect& e : plan.effects)
      s += fmt::format("  {:<20} {:<13} {}\n", e.name, sim::word_of(e.state), e.reason);
  else
    s += fmt::format("{} effects considered; -v, or explain, lists them\n", plan.effects.size());
  if (const auto fraction = run.contact_fraction())
    s += fmt::format(
        "beads are in contact for {:.3g} of the time{}\n", *fraction,
        *fraction > kHardBeads
            ? "; theories of hard beads, which assume instantaneous collisions, are not valid above 0.1"
            : "");
  s += fmt::format("{} after {} discarded, {:.3g} s, {:.3g} million particle-steps/s, {} built\n",
                   plural(scene.cycles, "cycle"), scene.discard, ended.seconds,
                   1e-6 * ended.particle_steps_per_second(), plural(run.list_builds(), "neighbour list"));
  if (ended.begun_at > 0) s += fmt::format("continued from step {} of a checkpoint\n", ended.begun_at);
  return s + ended.output + "\n";
}

/// The work of the solver that explains its time.
void state_counters(const sim::Solver& solver, Profile& profile) {
  const sim::Solver::Counters counters = solver.counters();
  profile.state("steps", counters.steps);
  profile.state("pair_visits", counters.pair_visits);
  profile.state("wall_visits", counters.wall_visits);
  profile.state("near_refreshes", counters.near_refreshes);
  profile.state("list_builds", solver.list_builds());
}

std::string failed_name(const std::string& output) {
  std::filesystem::path path(output);
  return path.replace_extension(".failed" + path.extension().string()).string();
}

/// Whether a run that is to be resumed has already finished. \throws ConfigError if the output exists but
/// belongs to another scene or to another file of the start
bool is_finished(const sim::Scene& scene, const SimulateOptions& options) {
  if (!options.resume || sim::CheckpointFolder::holds_a_run(sim::CheckpointFolder::of(options.output)) ||
      !std::filesystem::exists(options.output))
    return false;
  const std::string stored = H5mdReader(options.output).info().provenance_json;
  if (!sim::is_of_scene(stored, scene))
    throw ConfigError(
        {options.output, 0, 0, "--resume"},
        "the output belongs to another scene, and there is no checkpoint next to it to resume from.");
  if (sim::has_other_start(scene, stored))
    throw ConfigError(
        scene.where("start.from"),
        fmt::format("{} has changed since {} was written; without --resume the run begins again "
                    "and replaces it.",
                    scene.from.string(), options.output));
  return true;
}

/// The folder of checkpoints; null if the command line requests none. \throws ConfigError if the folder
/// contains an unfinished run and --resume is not given
std::unique_ptr<sim::CheckpointFolder> folder_for(const sim::Scene& scene, const SimulateOptions& options,
                                                  const std::function<std::string()>& provenance,
                                                  const Common& common) {
  const auto place = sim::CheckpointFolder::of(options.output);
  if (!options.resume && sim::CheckpointFolder::holds_a_run(place))
    throw ConfigError(
        {place.string(), 0, 0, ""},
        "contains an unfinished run; continue it with --resume, or remove the folder to start again.");
  if (!options.resume && !options.checkpoint_every) return nullptr;
  if (options.resume && !sim::CheckpointFolder::holds_a_run(place))
    note(common, "there is no checkpoint in " + place.string() + "; the run starts from the beginning.");
  return std::make_unique<sim::CheckpointFolder>(place, scene, provenance);
}

/// Runs the simulation. Its frames go directly to the file, or through a folder of checkpoints. If the run
/// fails, the frames so far are kept in a file named failed_name(output).
void run_into(H5mdWriter& writer, sim::Simulation& run, Progress& progress, sim::CheckpointFolder* folder,
              const std::string& output, StageTimes* times) {
  TrajectorySink& sink = folder != nullptr ? static_cast<TrajectorySink&>(*folder) : writer;
  try {
    run.run(sink, progress, std::numeric_limits<std::int64_t>::max(), times);
  } catch (const RunError& e) {
    std::filesystem::path kept;
    const auto keep = [&] { kept = writer.finish_as_failed(failed_name(output), e.what()); };
    try {
      if (folder != nullptr)
        folder->gather(writer, keep);
      else
        keep();
    } catch (const Error& not_kept) {  // says why the run failed in any case
      throw RunError(fmt::format("{} Its frames are lost: {}", e.what(), not_kept.what()));
    }
    throw RunError(std::string(e.what()) + " The frames up to that point are in " + kept.string() + ".");
  }
  const Stage finishing(times, "writing");
  if (folder == nullptr) return writer.finish();
  folder->save(run.state());  // gathering a long run takes time; if it is interrupted, no step is repeated
  folder->gather(writer, [&] { writer.finish(); });
}

sim::Scene read_scene(const SimulateOptions& options, const Common& common) {
  std::vector<std::string> assignments = with_seed(options.assignments, common);
  if (options.relax) assignments.emplace_back("start.relax=true");
  if (options.contacts) assignments.emplace_back("time.contacts=true");
  sim::Scene scene = sim::read_scene(options.scene, assignments);
  protect_named_inputs(common, scene.named_files());
  if (scene.until)
    note(common, fmt::format("[until] applies only to `measure` and `sweep`, which analyse during the run; "
                             "`simulate` runs all {} cycles.",
                             scene.cycles));
  note_units(common, scene);
  note_seed(common, scene, assignments);
  return scene;
}

/// Where a run begins: with the beads placed, or at a checkpoint.
struct RunStart {
  std::unique_ptr<sim::CheckpointFolder> checkpoints;  ///< null: none are saved
  sim::RunState state;
  std::string provenance;
  std::int64_t begun_at = 0;  ///< step of the drive; 0: at its beginning
};

/// Places the beads, or loads the checkpoint. The beads are placed once, before the folder of checkpoints is
/// created, so that an impossible start leaves no folder behind.
RunStart place_or_resume(const sim::Scene& scene, const SimulateOptions& options, const Common& common,
                         StageTimes* times) {
  ProgressBar placing(common, "placing beads");
  if (scene.n_beads) sim::require_disk(scene, sim::make_plan(scene), *scene.n_beads, options.output);
  const auto place = [&] {
    Stage stage(times, "placing", "beads");
    sim::RunState placed = sim::placed(scene, placing);
    stage.count(static_cast<double>(placed.beads.size()));
    return placed;
  };
  std::optional<sim::RunState> placed;
  if (!sim::CheckpointFolder::holds_a_run(sim::CheckpointFolder::of(options.output))) placed = place();
  const auto make_provenance = [&] {
    if (!placed) placed = place();
    return scene_provenance(common, scene, placed->beads, {options.scene});
  };
  RunStart start;
  start.checkpoints = folder_for(scene, options, make_provenance, common);
  const sim::CheckpointFolder* folder = start.checkpoints.get();
  const bool goes_on = folder != nullptr && folder->found();
  start.provenance = folder != nullptr ? folder->checkpoint().provenance : make_provenance();
  start.state = goes_on ? folder->checkpoint().state : std::move(*placed);
  start.begun_at = goes_on && start.state.driven ? start.state.step : 0;
  return start;
}

/// A run that cannot settle would fail again, so its checkpoints are removed.
void settle_with_checkpoints(sim::Simulation& run, sim::CheckpointFolder* folder, double every_s,
                             const Common& common, StageTimes* times) {
  SavingProgress settling(common, "settling", run, folder, every_s, times);
  try {
    run.settle(settling, times);
  } catch (const RunError&) {
    if (folder != nullptr) folder->remove();
    throw;
  }
}

/// Drives the bed and writes its frames. \returns the time that this took, s
double run_and_write(sim::Simulation& run, const std::string& output, const std::string& provenance,
                     sim::CheckpointFolder* folder, double every_s, const Common& common, StageTimes* times) {
  TrajectoryInfo info = run.trajectory_info();
  info.provenance_json = provenance;
  if (folder != nullptr) folder->announce(info);
  H5mdWriter writer(output, std::move(info));
  SavingProgress simulating(common, "simulating", run, folder, every_s, times);
  const auto begin = std::chrono::steady_clock::now();
  run_into(writer, run, simulating, folder, output, times);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void run_simulate(const SimulateOptions& options, const Common& common) {
  Profile profile(options.profile);
  sim::Scene scene = read_scene(options, common);
  if (is_finished(scene, options)) {
    note(common, options.output + " is finished; there is nothing to resume.");
    return;
  }
  RunStart start = place_or_resume(scene, options, common, profile.times());
  sim::CheckpointFolder* folder = start.checkpoints.get();
  const std::vector<std::string> told =
      sim::make_plan(scene, start.state.beads).warnings;  // printed now, because settling can take long
  for (const std::string& warning : told) note(common, warning);
  const auto speeds = sim::speeds_of_start(scene, start.state.beads);
  sim::Simulation run(std::move(scene), std::move(start.state), sim::SolverKind::best, common.threads);

  constexpr double kTenMinutes = 600;  // s
  const double every_s = options.checkpoint_every.value_or(kTenMinutes);
  settle_with_checkpoints(run, folder, every_s, common, profile.times());
  const std::vector<std::string> warnings = run.warnings();
  for (const std::string& warning : warnings)
    if (std::find(told.begin(), told.end(), warning) == told.end()) note(common, warning);

  const double seconds =
      run_and_write(run, options.output, start.provenance, folder, every_s, common, profile.times());
  FinishedRun ended{.run = run,
                    .plan = run.plan(),
                    .output = options.output,
                    .begun_at = start.begun_at,
                    .seconds = seconds};
  sim::state_step_error(run.scene(), ended.plan, speeds);
  nlohmann::json document = describe(ended);
  document["warnings"] = warnings;
  std::string text = as_text(ended, common.verbose);
  state_counters(run.solver(), profile);
  profile.add_to(document, text, sim::threads_for(run.system().beads.size(), common.threads));
  print_result(common, document, text);
}

}  // namespace

void add_simulate(CLI::App& program, Common& common) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App& verb =
      add_verb(program, common, "simulate",
               "Run a scene and write its trajectory. Prints the drive, the time step, the effects that are "
               "on or off, and the speed of the run.",
               "twincell simulate scene.toml -o sim.h5 --set drive.gamma=1.8 --set time.cycles=10");
  takes_seed(verb, common);
  has_details(verb, "the effects that are on, off or approximated, with reasons");
  verb.add_option("scene", options->scene, "Scene file (TOML, docs/scene.md)")->required();
  writes(common, verb,
         verb.add_option("-o,--output", options->output, "Trajectory file to write (H5MD)")->required(),
         Product::trajectory(word_of(Origin::simulation)));
  verb.add_option("--set", options->assignments,
                  "Set a key of the scene, as section.key=value; overrides the file; may be repeated")
      ->take_all();
  verb.add_flag("--relax", options->relax,
                "Push overlapping beads of the start apart, however deep the overlap");
  verb.add_flag(
      "--contacts", options->contacts,
      "Store the contacts of every frame: pair, overlap, normal and tangential force, for the "
      "forces and the stress of `analyze` and the force chains of `export --to vtk`; and the springs "
      "of the contacts, with which a start in motion continues the run");
  verb.add_option("--checkpoint-every", options->checkpoint_every,
                  "Time between checkpoints in OUTPUT.checkpoint/, s; 0: only at SIGINT and SIGTERM; "
                  "default: no checkpoints, with --resume every 600 s")
      ->check(zero_or_above());
  verb.add_flag("--resume", options->resume,
                "Continue the run in OUTPUT.checkpoint/, or start it if there is none; saves a checkpoint "
                "every 600 s unless --checkpoint-every is given");
  add_profile_option(verb, options->profile);
  verb.callback([options, &common] { run_simulate(*options, common); });
}

}  // namespace twincell::cli
