// twincell sweep plan|run|status|collect|template PLAN.toml

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/mpi_farm.hpp"
#include "cli/output.hpp"
#include "cli/sweep_watch.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/output_rules.hpp"
#include "sweep/collect.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

namespace {

namespace fs = std::filesystem;
using sweep::Counts;

Product collected_product() {
  return Product::json("the results of a sweep", "points");
}

struct SweepOptions {
  std::string plan, folder, shard, output, engine;
  bool mpi = false, keep_trajectories = false;
  int jobs = 8;
};

fs::path folder_of(const SweepOptions& options) {
  if (!options.folder.empty()) return options.folder;
  return fs::path(options.plan).replace_extension(".sweep");
}

sweep::Plan plan_of(const SweepOptions& options, const Common& common) {
  sweep::Plan plan = sweep::read_plan(options.plan);
  if (common.seed) plan.seed = *common.seed;
  return plan;
}

/// The folder of a sweep that has been begun. \throws InputError if there is none
sweep::Store store_of(const SweepOptions& options) {
  const fs::path folder = folder_of(options);
  if (!fs::is_directory(folder / "points"))
    throw InputError({folder.string(), 0, 0, ""}, "there is no sweep in this place; 'sweep run' makes one.");
  return sweep::Store(folder, sweep::Store::Access::read);
}

sweep::Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  sweep::Shard shard;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.of, &rest) != 2 || shard.of < 1 ||
      shard.index < 1 || shard.index > shard.of)
    throw ConfigError({"", 0, 0, "--shard"}, fmt::format("'{}' is not a part i/n with 1 <= i <= n.", text));
  return shard;
}

nlohmann::json as_json(const Counts& counts, const fs::path& folder, bool all) {
  return {{"folder", folder.string()},
          {"points", counts.known},
          {"done", counts.done},
          {"failed", counts.failed},
          {"particle_steps_left", counts.work_left},
          {"complete", all}};
}

/// Points of unfinished curves that some process works at.
std::size_t running(const sweep::Schedule& schedule, const sweep::Store& store) {
  std::size_t n = 0;
  for (const sweep::Curve& curve : schedule.curves())
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      n += !curve.results[i] && store.claimed(curve.points[i]) ? 1 : 0;
  return n;
}

/// Says once which runs of the plan are left out.
void note_repeats(const sweep::Schedule& schedule, const Common& common) {
  if (const std::string text = schedule.repeats_text(); !text.empty()) note(common, text);
}

void run_plan(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store(folder_of(options));
  const sweep::Schedule schedule(plan, store);
  require_memory_together(schedule, common.n_threads(), "--threads");
  for (const sweep::Curve& curve : schedule.curves())
    for (const sweep::Point& point : curve.points)
      if (const auto claim = store.claim(point)) store.announce(plan, point);
  const Counts counts = schedule.counts();
  note_repeats(schedule, common);
  nlohmann::json document = as_json(counts, store.folder(), schedule.all());
  document["repeats_left_out"] = schedule.repeats();
  print_result(
      common, document,
      fmt::format("{} point{}{}, {} done, {:.3g} particle-steps to go\n{}\n", counts.known,
                  counts.known == 1 ? "" : "s",
                  plan.search ? fmt::format(" in the first round of {} search{}", schedule.curves().size(),
                                            schedule.curves().size() == 1 ? "" : "es")
                              : "",
                  counts.done, counts.work_left, store.folder().string()));
}

void run_run(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Shard shard = shard_of(options.shard);
  std::optional<MpiJob> job;
  if (options.mpi) job.emplace();
  const sweep::Store store(folder_of(options));
  std::optional<sweep::Schedule> schedule;
  if (!job || job->is_master()) schedule.emplace(plan, store, shard);
  if (schedule) {
    note_repeats(*schedule, common);
    if (!job) require_memory_together(*schedule, common.n_threads(), "--threads");
  }
  {
    SweepWatch watch(common);
    if (job)
      run_on_ranks(schedule ? &*schedule : nullptr, plan, store, options.keep_trajectories, watch);
    else
      run_here({&*schedule}, store, {common.n_threads(), options.keep_trajectories}, watch);
  }
  if (!schedule) return;
  nlohmann::json document = as_json(schedule->counts(), store.folder(), schedule->all());
  document["shard"] = options.shard.empty() ? "1/1" : options.shard;
  print_result(common, document, collected_text(*schedule) + store.folder().string() + "\n");
}

void run_status(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store = store_of(options);
  const sweep::Schedule schedule(plan, store);
  const Counts counts = schedule.counts();
  const std::size_t now = running(schedule, store);
  // By what the done points took, each on one core.
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
    text += fmt::format(", about {} of one core left for the known points",
                        time_text(counts.work_left * seconds / work));
  print_result(common, document, text + "\n");
}

void run_collect(const SweepOptions& options, const Common& common) {
  const sweep::Plan plan = plan_of(options, common);
  const sweep::Store store = store_of(options);
  const fs::path output = options.output.empty() ? store.folder() / "results.json" : fs::path(options.output);
  const sweep::Schedule schedule(plan, store);
  note_repeats(schedule, common);
  const std::string json = collected_json(schedule);
  const std::string csv = collected_csv(schedule), pooled = pooled_csv(schedule);
  const fs::path table = fs::path(output).replace_extension(".csv"),
                 pooled_table = fs::path(output).replace_extension(".pooled.csv");
  if (output == kStandardOutput) {
    write_text_file(output, json, collected_product());
    return print_result(common, {}, collected_text(schedule));
  }
  // All of them or none.
  require_output(table, Product::table(csv));
  if (!pooled.empty()) require_output(pooled_table, Product::table(pooled));
  write_text_file(output, json, collected_product());
  write_text_file(table, csv, Product::table(csv));
  if (!pooled.empty()) write_text_file(pooled_table, pooled, Product::table(pooled));
  if (!schedule.all()) note(common, "not all points are done; the file says how many are open.");
  print_result(common, nlohmann::json::parse(json), collected_text(schedule) + output.string() + "\n");
}

void run_template(const SweepOptions& options) {
  const std::string run = fmt::format("twincell sweep run {} -o {} --threads 1 --quiet",
                                      shell_word(options.plan), shell_word(folder_of(options).string()));
  if (options.engine == "slurm")
    fmt::print(
        "#!/bin/bash\n"
        "# sbatch this file, in a folder that all nodes see. Submit it again after a loss: nothing is done "
        "twice.\n"
        "#SBATCH --job-name=twincell\n"
        "#SBATCH --array=1-{0}\n"
        "#SBATCH --cpus-per-task=1\n"
        "#SBATCH --time=24:00:00\n"
        "{1} --shard \"$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT\"\n",
        options.jobs, run);
  else
    fmt::print(
        "#!/bin/bash\n"
        "# With --sshloginfile NODES parallel uses other machines too, if they see this folder.\n"
        "parallel -q --halt soon,fail=1 {1} --shard {{}}/{0} ::: $(seq {0})\n",
        options.jobs, run);
}

}  // namespace

void add_sweep(CLI::App& program, Common& common) {
  CLI::App& verb =
      *program.add_subcommand("sweep", "Many scenes: a grid, or a search for where a verdict flips");
  verb.require_subcommand(1);
  verb.footer(
      "Example:\n  twincell sweep run plan.toml && twincell sweep collect plan.toml -o results.json\n"
      "Plans: docs/sweeps.md");
  auto options = std::make_shared<SweepOptions>();
  const auto add = [&](const char* name, const char* summary, const char* example) -> CLI::App& {
    CLI::App& sub = add_verb(verb, common, name, summary, example);
    sub.add_option("plan", options->plan, "Plan (TOML, docs/sweeps.md)")->required();
    // The folder is held against the rules where the sweep is begun (sweep/store.cpp).
    common.outputs.push_back(
        {sub.add_option(std::string(name) == "collect" ? "--folder" : "-o,--output,--folder", options->folder,
                        "Folder of the sweep; PLAN.sweep if not said")
             ->check([](const std::string& said) {
               return said.empty() ? std::string("The folder of the sweep has no name.") : std::string();
             }),
         nullptr, Product::runs()});
    return sub;
  };
  CLI::App& plan = add("plan", "Write down the points that the plan needs", "twincell sweep plan plan.toml");
  plan.callback([options, &common] { run_plan(*options, common); });

  CLI::App& run = add("run", "Compute them, a point on each core; again, to go on after any stop",
                      "twincell sweep run plan.toml\n  mpirun -n 16 twincell sweep run plan.toml --mpi");
  run.add_option("--shard", options->shard, "Part i/n of the points, or of the searches");
  run.add_flag("--mpi", options->mpi, "The ranks of this MPI job compute, a point on each");
  run.add_flag("--keep-trajectories", options->keep_trajectories,
               "Keep trajectory.h5 of every point computed now");
  run.callback([options, &common] { run_run(*options, common); });

  CLI::App& status = add("status", "How far it is", "twincell sweep status plan.toml");
  status.callback([options, &common] { run_status(*options, common); });

  CLI::App& collect = add("collect", "All results in one file, JSON and CSV",
                          "twincell sweep collect plan.toml -o results.json");
  writes(common, collect,
         collect.add_option("-o,--output", options->output,
                            "FILE.json; FILE.csv and, of several seeds, FILE.pooled.csv are written beside "
                            "it; -: the JSON alone"),
         collected_product());
  collect.callback([options, &common] { run_collect(*options, common); });

  CLI::App& script = *verb.add_subcommand("template", "A script for Slurm or GNU parallel");
  script.footer("Example:\n  twincell sweep template slurm plan.toml --jobs 32 > sweep.sbatch");
  script.add_option("engine", options->engine, "slurm or parallel")
      ->required()
      ->check(CLI::IsMember({"slurm", "parallel"}));
  script.add_option("plan", options->plan, "Plan (TOML)")->required();
  script.add_option("-o,--output,--folder", options->folder, "Folder of the sweep; PLAN.sweep if not said");
  script.add_option("--jobs", options->jobs, "Shards")->check(CLI::Range(1, 100000))->capture_default_str();
  script.callback([options] { run_template(*options); });
}

}  // namespace twincell::cli
