// twincell compare: both sides in one report.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/report.hpp"
#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "cli/comparing_options.hpp"
#include "cli/verb.hpp"

namespace twincell::cli {
namespace {

struct CompareOptions {
  std::string output;
  ComparingFlags flags;
  bool trust_stated_drive = false;
};

/// Refuses experiments of which `track` saw that the plate in the film does not move as their cell says.
void require_drive_of_film(const std::vector<std::filesystem::path>& experiments) {
  for (const std::filesystem::path& file : experiments) {
    const auto tracking = nlohmann::json::parse(H5mdReader(file).info().tracking_json, nullptr, false);
    if (!tracking.is_object() || !tracking.contains("drive_disagreement")) continue;
    const auto& clause = tracking["drive_disagreement"];
    throw ConfigError(
        {.file = file.string(), .key = "drive"},
        (clause.is_string() ? clause.get<std::string>() : "the stated drive does not fit the film") +
            "; correct the cell and track again, or say --trust-stated-drive.");
  }
}

void run(const Common& common, CompareOptions& o) {
  resolve(o.flags, common);
  const ComparingOptions& options = o.flags.options;
  if (options.experiments.empty() && options.simulations.empty())
    throw ConfigError({.file = {}, .key = "compare"},
                      options.sweeps.empty()
                          ? "there is nothing to compare: give --experiment and --simulation trajectories"
                          : "a sweep's results hold no bed to look at: give --simulation or --experiment "
                            "trajectories too, as sweep run --keep-trajectories leaves them in points/");
  if (!o.trust_stated_drive) require_drive_of_film(options.experiments);
  compare_and_report(common, options, o.output, nlohmann::json::object(), "");
}

}  // namespace

void add_compare(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "compare",
      "experiment and simulation side by side: phase diagram, differences and where they come from, one "
      "report",
      "twincell compare --experiment exp_15.h5 exp_20.h5 --simulation sim_15.h5 sim_20.h5 -o report");
  auto o = std::make_shared<CompareOptions>();
  verb.add_option("--experiment", o->flags.options.experiments, "trajectories of the experiment (H5MD)");
  verb.add_option("--simulation", o->flags.options.simulations, "trajectories of the simulation (H5MD)");
  verb.add_option("--frames", o->flags.options.stacks,
                  "stacks of the experiments, in their order, to be shown; absent: where they were tracked");
  verb.add_option("--sweep", o->flags.options.sweeps,
                  "collected results of sweeps (JSON): their points and onsets");
  writes(common, verb, verb.add_option("-o,--output", o->output, "folder of the report")->required(),
         report_folder());
  add_comparing_flags(verb, o->flags);
  verb.add_flag(
      "--trust-stated-drive", o->trust_stated_drive,
      "believe the drive that the experiments' cells state though the plate in the film moves otherwise");
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
