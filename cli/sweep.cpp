// twincell sweep plan|run|status|collect|plot|template PLAN.toml: many scenes, their results and their
// progress.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "cli/device_option.hpp"
#include "cli/mpi_farm.hpp"
#include "cli/output.hpp"
#include "cli/profile.hpp"
#include "cli/sweep_watch.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "sim/run/make_solver.hpp"
#include "sweep/collect.hpp"
#include "sweep/farm.hpp"
#include "sweep/point_warnings.hpp"
#include "sweep/results_figure.hpp"

namespace twincell::cli {

namespace {

namespace fs = std::filesystem;
using sweep::Counts;

Product collected_product() {
  return Product::json("the results of a sweep", "points");
}

struct SweepOptions {
  std::string plan, folder, shard, output, engine, device;
  sweep::FigureOptions figure;
  bool mpi = false, keep_trajectories = false, profile = false;
  int jobs = 8;
};

fs::path folder_of(const SweepOptions& options) {
  if (!options.folder.empty()) return options.folder;
  return fs::path(options.plan).replace_extension(".sweep");
}

sweep::Plan plan_of(const SweepOptions& options, const Common& common) {
  if (std::error_code ec; fs::is_directory(options.plan, ec))
    throw ConfigError({options.plan, 0, 0, "plan"},
                      "is a folder; name the plan (TOML), and the folder of the sweep with --folder.");
  sweep::Plan plan = sweep::read_plan(options.plan);
  protect_named_inputs(common, {plan.scene_name});
  if (common.seed) plan.seed = *common.seed;
  for (const std::string& doubt : plan.doubts) note(common, doubt);
  return plan;
}

/// Prints warnings about the points, each kind of them once.
class PointNotes {
 public:
  explicit PointNotes(const Common& common) : common_(common) {}
  /// \returns all warnings so far
  std::vector<std::string> note_new(const sweep::Schedule& schedule) {
    std::vector<std::string> all;
    for (const sweep::PointWarning& warning : sweep::warnings_of(schedule)) {
      all.push_back(warning.sentence());
      if (told_.insert(warning.kind).second) note(common_, all.back());
    }
    return all;
  }

 private:
  const Common& common_;
  std::set<std::string> told_;
};

/// Opens the folder of an existing sweep. \throws InputError if there is none
sweep::Store store_of(const SweepOptions& options) {
  const fs::path folder = folder_of(options);
  if (!fs::is_directory(folder / "points"))
    throw InputError({folder.string(), 0, 0, ""},
                     "there is no sweep in this folder; 'sweep run' creates one.");
  return sweep::Store(folder, sweep::Store::Access::read);
}

sweep::Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  sweep::Shard shard;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.of, &rest) != 2 || shard.of < 1 ||
      shard.index < 1 || shard.index > shard.of)
    throw ConfigError({"", 0, 0, "--shard"},
                      fmt::format("'{}' is not of the form i/n with 1 <= i <= n.", text));
  return shard;
}

nlohmann::json as_json(const Counts& counts, const fs::path& folder, bool all) {
  return {{"folder", folder.string()},
          {"points", counts.known},
          {"done", counts.done},
          {"failed", counts.failed},
          {"particle_steps_left", counts.work_left},
          {"most_points", counts.most},
          {"most_particle_steps_left", counts.most_work},
          {"complete", all}};
}

/// Number of points without a result that a process is computing now.
std::size_t running(const sweep::Schedule& schedule, const sweep::Store& store) {
  std::size_t n = 0;
  for (const sweep::Curve& curve : schedule.curves())
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      n += !curve.results[i] && store.claimed(curve.points[i]) ? 1 : 0;
  return n;
}

/// Prints one note on the runs of the plan that are left out because they would repeat another run.
void note_repeats(const sweep::Schedule& schedule, const Common& common) {
  if (const std::string text = schedule.repeats_text(); !text.empty()) note(common, text);
}

/// Notes how many results in the folder belong to an earlier state of the scene or the plan.
void note_foreign(const sweep::Schedule& schedule, const sweep::Store& store, const Common& common) {
  std::set<std::string> known;
  for (const sweep::Curve& curve : schedule.curves())
    for (const sweep::Point& point : curve.points) known.insert(point.id);
  const std::vector<std::string> stored = store.finished();
  const auto foreign =
      std::count_if(stored.begin(), stored.end(), [&](const std::string& id) { return !known.contains(id); });
  if (foreign > 0)
    note(common, fmt::format("{}: {} of another scene, seed or plan {} there and {} not used.",
                             store.folder().string(), plural(static_cast<std::size_t>(foreign), "result"),
                             foreign == 1 ? "is" : "are", foreign == 1 ? "is" : "are"));
}

void run_plan(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store(folder_of(options));
  const sweep::Schedule schedule(plan, store);
  require_memory_together(schedule, common.n_threads(), "--threads");
  const std::vector<std::string> warnings = PointNotes(common).note_new(schedule);
  for (const sweep::Curve& curve : schedule.curves())
    for (const sweep::Point& point : curve.points)
      if (const auto claim = store.claim(point)) store.announce(plan, point);
  const Counts counts = schedule.counts();
  note_repeats(schedule, common);
  note_foreign(schedule, store, common);
  nlohmann::json document = as_json(counts, store.folder(), schedule.all());
  document["repeats_left_out"] = schedule.repeats();
  document["warnings"] = warnings;
  print_result(
      common, document,
      fmt::format("{} point{}{}, {} done, {:.3g} particle-steps left{}\n{}\n", counts.known,
                  counts.known == 1 ? "" : "s",
                  plan.search ? fmt::format(" in the first round of {} search{}", schedule.curves().size(),
                                            schedule.curves().size() == 1 ? "" : "es")
                              : "",
                  counts.done, counts.work_left,
                  counts.most > counts.known
                      ? fmt::format("; at most {} points, {:.3g} particle-steps in all rounds", counts.most,
                                    counts.most_work)
                      : "",
                  store.folder().string()));
}

/// \param files that are certainly written
Product figures_folder(std::vector<std::string> files = {}) {
  return Product::shared_folder("the figures of a sweep", std::move(files));
}

/// Draws a result into `folder`. \returns the path of the SVG
std::string draw_results(const sweep::Schedule& schedule, const sweep::FigureOptions& options,
                         const fs::path& folder) {
  const analysis::Figure figure = sweep::results_figure(collected_json(schedule), options);
  AtomicPath output(folder, figures_folder(analysis::figure_files(figure.name)));
  analysis::draw(figure, output.part());
  output.commit();
  return (folder / (figure.name + ".svg")).string();
}

/// The picture of a sweep that this process completed. Without one the results are complete all the same, so
/// its failure (no gnuplot, no axis with numbers, another process that draws it now) is a note.
std::optional<std::string> final_picture(const sweep::Schedule& schedule, const sweep::Store& store,
                                         const Common& common) {
  try {
    return draw_results(schedule, {}, store.folder() / "figures");
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& e) {
    note(common, fmt::format("no picture was drawn: {}", e.what()));
    return std::nullopt;
  }
}

void run_run(const SweepOptions& options, const Common& common) {
  const Workers workers = workers_of(options.device, common);
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Shard shard = shard_of(options.shard);
  Profile profile(options.profile);
  std::optional<MpiJob> job;
  if (options.mpi) job.emplace();
  const sweep::Store store(folder_of(options));
  std::optional<sweep::Schedule> schedule;
  if (!job || job->is_master()) schedule.emplace(plan, store, shard);
  PointNotes notes(common);
  if (schedule) {
    note_repeats(*schedule, common);
    notes.note_new(*schedule);
    if (!job) require_memory_together(*schedule, workers.count, "--threads");
  }
  {
    SweepWatch watch(common);
    if (job)
      run_on_ranks(schedule ? &*schedule : nullptr, plan, store, options.keep_trajectories, watch);
    else {
      const sweep::FarmOptions farm{workers.count, options.keep_trajectories, profile.sum(), workers.solver};
      announce({&*schedule}, farm, watch);
      run_here({&*schedule}, store, farm, watch);
    }
  }
  if (!schedule) return;
  nlohmann::json document = as_json(schedule->counts(), store.folder(), schedule->all());
  document["warnings"] = notes.note_new(*schedule);
  document["shard"] = options.shard.empty() ? "1/1" : options.shard;
  std::string text = collected_text(*schedule) + store.folder().string() + "\n";
  if (options.shard.empty() && schedule->all())
    if (const auto picture = final_picture(*schedule, store, common)) {
      document["figure"] = *picture;
      text += fmt::format("picture: {}; sweep plot draws other results\n", *picture);
    }
  profile.add_to(document, text, workers.count);
  print_result(common, document, text);
}

void run_status(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store = store_of(options);
  const sweep::Schedule schedule(plan, store);
  const Counts counts = schedule.counts();
  const std::size_t now = running(schedule, store);
  note_foreign(schedule, store, common);
  // The remaining time is estimated from the time of the finished points, each of which ran on one core.
  double seconds = 0, work = 0;
  for (const sweep::Curve& curve : schedule.curves())
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      if (curve.results[i]) {
        seconds += nlohmann::json::parse(*curve.results[i])["computed"].value("seconds", 0.0);
        work += curve.points[i].work;
      }
  nlohmann::json document = as_json(counts, store.folder(), schedule.all());
  document["running"] = now;
  document["core_seconds_left"] =
      work > 0 ? nlohmann::json(counts.work_left * seconds / work) : nlohmann::json();
  std::string text = collected_text(schedule);
  text += fmt::format("{} running", now);
  if (work > 0 && counts.work_left > 0)
    text += fmt::format(", about {} left on one core for the known points",
                        time_text(counts.work_left * seconds / work));
  print_result(common, document, text + "\n");
}

/// \throws ConfigError if the output is in a folder of the sweep's points, whose files are the input of
/// collect
void refuse_place_among_points(const fs::path& output, const fs::path& folder) {
  if (output == kStandardOutput) return;
  std::error_code ec;
  const fs::path points = fs::weakly_canonical(folder / "points", ec);
  const fs::path place = fs::weakly_canonical(output, ec);
  const auto [end, ignored] = std::mismatch(points.begin(), points.end(), place.begin(), place.end());
  if (end == points.end() && !points.empty())
    throw ConfigError({.file = output.string(), .key = "-o"},
                      fmt::format("is among the points of the sweep in {}; name a place outside of it.",
                                  (folder / "points").string()));
}

void run_collect(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  // The place of the table follows from the name of the output. It is checked before any work, as that is.
  if (!options.output.empty() && options.output != kStandardOutput)
    require_output(fs::path(options.output).replace_extension(".csv"), sweep::collected_csv_file());
  const sweep::Store store = store_of(options);
  const fs::path output = options.output.empty() ? store.folder() / "results.json" : fs::path(options.output);
  refuse_place_among_points(output, store.folder());
  const sweep::Schedule schedule(plan, store);
  note_repeats(schedule, common);
  note_foreign(schedule, store, common);
  const std::string json = collected_json(schedule);
  const std::string csv = collected_csv(schedule), pooled = pooled_csv(schedule);
  const fs::path table = fs::path(output).replace_extension(".csv"),
                 pooled_table = fs::path(output).replace_extension(".pooled.csv");
  if (output == kStandardOutput) {
    write_text_file(output, json, collected_product());
    return print_result(common, {}, collected_text(schedule));
  }
  // All outputs are checked before the first one is written: either all are written or none.
  require_output(table, sweep::collected_csv_file());
  if (!pooled.empty()) require_output(pooled_table, sweep::pooled_csv_file());
  write_text_file(output, json, collected_product());
  write_text_file(table, csv, sweep::collected_csv_file());
  if (!pooled.empty()) write_text_file(pooled_table, pooled, sweep::pooled_csv_file());
  const nlohmann::json document = nlohmann::json::parse(json);
  // Curves of results that the plan does not name are not missed.
  if (const auto outside = sweep::results_outside_csv(document); !plan.results.empty() && !outside.empty())
    note(common,
         fmt::format("no single numbers, so only in {}: {}.", output.string(), fmt::join(outside, ", ")));
  if (!schedule.all()) note(common, "not all points are done; the file states how many are open.");
  print_result(common, document,
               fmt::format("{}{}\n{}\n{}", collected_text(schedule), output.string(), table.string(),
                           pooled.empty() ? "" : pooled_table.string() + "\n"));
}

void run_plot(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store = store_of(options);
  const sweep::Schedule schedule(plan, store);
  if (!schedule.all()) note(common, "not all points are done; the figure shows those that are.");
  const fs::path folder = options.output.empty() ? store.folder() / "figures" : fs::path(options.output);
  const std::string file = draw_results(schedule, options.figure, folder);
  print_result(common, {{"figure", file}}, fmt::format("picture: {} (also .pdf, .png)\n", file));
}

void run_template(const SweepOptions& options) {
  const std::string run = fmt::format("twincell sweep run {} --folder {} --threads 1 --quiet",
                                      shell_word(options.plan), shell_word(folder_of(options).string()));
  if (options.engine == "slurm")
    fmt::print(
        "#!/bin/bash\n"
        "# Submit this file with sbatch in a folder that all nodes can see. After a failure, submit it "
        "again: finished points are not repeated.\n"
        "#SBATCH --job-name=twincell\n"
        "#SBATCH --array=1-{0}\n"
        "#SBATCH --cpus-per-task=1\n"
        "#SBATCH --time=24:00:00\n"
        "{1} --shard \"$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT\"\n",
        options.jobs, run);
  else
    fmt::print(
        "#!/bin/bash\n"
        "# With --sshloginfile NODES, parallel also uses other machines, if they can see this folder.\n"
        "parallel -q --halt soon,fail=1 {1} --shard {{}}/{0} ::: $(seq {0})\n",
        options.jobs, run);
}

using Options = std::shared_ptr<SweepOptions>;

/// Adds a subcommand that reads the plan and the folder of the sweep.
CLI::App& add_stage(CLI::App& verb, Common& common, const Options& options, const char* name,
                    const char* summary, const char* example) {
  CLI::App& sub = add_verb(verb, common, name, summary, example);
  takes_seed(sub, common);
  sub.add_option("plan", options->plan, "Plan file (TOML, docs/sweeps.md)")->required();
  // The folder is checked against the output rules when the sweep starts (sweep/store.cpp).
  common.outputs.push_back(
      {sub.add_option("--folder", options->folder, "Folder of the sweep; default: PLAN.sweep")
           ->check([](const std::string& said) {
             return said.empty() ? std::string("The folder of the sweep has no name.") : std::string();
           }),
       nullptr, Product::runs()});
  if (std::string(name) != "collect")
    former_option(sub, "-o,--output", std::string(name) == "plot" ? "--figures" : "--folder");
  return sub;
}

void add_plan(CLI::App& verb, Common& common, const Options& options) {
  CLI::App& plan = add_stage(
      verb, common, options, "plan",
      "Write the points that the plan needs into the folder of the sweep, and print their number and cost",
      "twincell sweep plan plan.toml");
  plan.callback([options, &common] { run_plan(*options, common); });
}

void add_run(CLI::App& verb, Common& common, const Options& options) {
  CLI::App& run =
      add_stage(verb, common, options, "run",
                "Compute the points, one on each core, and store their results. After a stop, "
                "the same command continues.",
                "twincell sweep run plan.toml\n  mpirun -n 16 twincell sweep run plan.toml --mpi");
  run.add_option("--shard", options->shard,
                 "Compute only shard i of n, as i/n: every n-th point of a grid, or every n-th search; "
                 "default: 1/1, all");
  run.add_flag("--mpi", options->mpi, "Compute on the ranks of this MPI job, one point on each rank");
  add_device_option(run, options->device)->excludes("--mpi");
  run.add_flag("--keep-trajectories", options->keep_trajectories,
               "Store trajectory.h5 of every point that this command computes");
  add_profile_option(run, options->profile);
  run.get_option("--profile")->excludes("--mpi");
  run.callback([options, &common] { run_run(*options, common); });
}

void add_status(CLI::App& verb, Common& common, const Options& options) {
  CLI::App& status =
      add_stage(verb, common, options, "status",
                "Print how many points are done, running and failed, the onsets so far, and the time left",
                "twincell sweep status plan.toml");
  status.callback([options, &common] { run_status(*options, common); });
}

void add_collect(CLI::App& verb, Common& common, const Options& options) {
  CLI::App& collect =
      add_stage(verb, common, options, "collect", "Write all results to one file, as JSON and as CSV tables",
                "twincell sweep collect plan.toml -o results.json");
  writes(common, collect,
         collect
             .add_option("-o,--output", options->output,
                         "Output file FILE.json or FILE.csv; both are written and, for several seeds, "
                         "FILE.pooled.csv; '-': only the JSON, to standard output; default: results.json in "
                         "the folder of the sweep")
             ->transform([](const std::string& said) {
               const fs::path name(said);
               return name.extension() == ".csv" ? fs::path(name).replace_extension(".json").string() : said;
             }),
         collected_product());
  collect.callback([options, &common] { run_collect(*options, common); });
}

void add_plot(CLI::App& verb, Common& common, const Options& options) {
  CLI::App& plot = add_stage(verb, common, options, "plot",
                             "Draw a result, or the onsets of a search, over one or two axes, with intervals",
                             "twincell sweep plot plan.toml --result s_b --over drive.gamma beads.layers");
  plot.add_option("--result", options->figure.result,
                  "Name of a scalar result; default: the onsets of a search, otherwise s_c")
      ->type_name(kWord);
  plot.add_option(
          "--over", options->figure.over,
          "Axis of the plan to plot against, and a second axis that separates the curves; default: the axis "
          "with the most values")
      ->type_name(kWord)
      ->expected(1, 2);
  writes(common, plot,
         plot.add_option("--figures", options->output,
                         "Folder for the figure and its data; default: figures in the folder of the sweep"),
         figures_folder());
  plot.callback([options, &common] { run_plot(*options, common); });
}

void add_template(CLI::App& verb, const Options& options) {
  CLI::App& script =
      *verb.add_subcommand("template", "Print a script that runs the sweep with Slurm or GNU parallel");
  script.footer("Example:\n  twincell sweep template slurm plan.toml --jobs 32 > sweep.sbatch");
  script.add_option("engine", options->engine, "Program that runs the script: slurm or parallel")
      ->required()
      ->check(CLI::IsMember({"slurm", "parallel"}));
  script.add_option("plan", options->plan, "Plan file (TOML)")->required();
  script.add_option("--folder", options->folder, "Folder of the sweep; default: PLAN.sweep");
  former_option(script, "-o,--output", "--folder");
  script.add_option("--jobs", options->jobs, "Number of shards into which the sweep is divided")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  script.callback([options] { run_template(*options); });
}

}  // namespace

void add_sweep(CLI::App& program, Common& common) {
  CLI::App& verb = *program.add_subcommand(
      "sweep",
      "Run many scenes: a grid of parameters, or a search for the value at which a verdict changes. Each "
      "point is stored in the folder of the sweep, so a stopped sweep can be continued.");
  verb.require_subcommand(1);
  verb.footer(
      "Example:\n"
      "  twincell sweep run plan.toml && twincell sweep collect plan.toml -o results.json\n"
      "Plans: docs/sweeps.md");
  const auto options = std::make_shared<SweepOptions>();
  add_plan(verb, common, options);
  add_run(verb, common, options);
  add_status(verb, common, options);
  add_collect(verb, common, options);
  add_plot(verb, common, options);
  add_template(verb, options);
}

}  // namespace twincell::cli
