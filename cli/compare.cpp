// twincell compare: experiments and simulations in one report.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "calibration/drive/plate_drive.hpp"
#include "cli/comparing_options.hpp"
#include "cli/trajectory_notes.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/tracking_record.hpp"

namespace twincell::cli {
namespace {

struct CompareOptions {
  std::vector<std::filesystem::path> experiments, simulations, stacks, sweeps;
  std::string output;
  ComparingFlags flags;
  bool trust_stated_drive = false;
};

/// How the drive in the film differs from the drive that the experiment states, as one clause; empty if it
/// does not. Uses the check that `track` stored. Without a stored check it compares with the motion of the
/// bed.
std::string drive_disagreement(const H5mdReader& experiment) {
  const TrajectoryInfo& info = experiment.info();
  if (auto recorded = recorded_disagreement(info)) return *recorded;
  if (info.source != Origin::experiment || !info.drive) return {};
  calibration::BedSteps bed(info);
  Frame frame;
  for (std::size_t f = 0; f < experiment.n_frames(); ++f) {
    experiment.read(f, frame);
    bed.append(frame);
  }
  return calibration::check_by_bed(bed, info, std::nullopt).disagreement;
}

/// \throws ConfigError if the film of an experiment shows another drive than its cell states
void require_drive_of_film(const std::vector<std::filesystem::path>& experiments) {
  for (const std::filesystem::path& file : experiments)
    if (const std::string clause = drive_disagreement(H5mdReader(file)); !clause.empty())
      throw ConfigError({.file = file.string(), .key = "drive"},
                        clause + "; correct the cell and track again, or give --trust-stated-drive.");
}

/// \throws ConfigError if there is nothing to compare
void require_sides(const CompareOptions& o) {
  if (o.experiments.empty() && o.simulations.empty() && o.sweeps.empty())
    throw ConfigError({.file = {}, .key = "compare"},
                      "there is nothing to compare: give --experiment and --simulation trajectories, or the "
                      "results of a --sweep.");
}

twin::ComparingOptions configuration(const CompareOptions& o, const Common& common) {
  twin::ComparingOptions options = comparing_options(o.flags, common);
  options.experiments = o.experiments;
  options.simulations = o.simulations;
  options.stacks = o.stacks;
  options.sweeps = o.sweeps;
  return options;
}

void run(const Common& common, const CompareOptions& o) {
  const twin::ComparingOptions options = configuration(o, common);
  require_sides(o);
  for (const auto& side : {o.experiments, o.simulations})
    for (const std::filesystem::path& file : side) note_trajectory(common, H5mdReader(file));
  if (!o.trust_stated_drive) require_drive_of_film(o.experiments);
  const analysis::Comparison compared = compare_sides(common, options);
  report_comparison(common, options, compared, o.output, nlohmann::json::object(), "");
}

}  // namespace

void add_compare(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "compare",
      "Compare experiments with simulations: phase diagram, phase boundaries, differences and their sources. "
      "Prints the comparison and writes a report.",
      "twincell compare --experiment twin/experiment.h5 --simulation twin/simulation-1.h5 "
      "twin/simulation-2.h5 -o report");
  takes_seed(verb, common);
  has_details(verb, "all compared numbers, with the parts of their errors and the causes");
  auto o = std::make_shared<CompareOptions>();
  verb.add_option("--experiment", o->experiments, "Trajectories of the experiments (H5MD)");
  verb.add_option("--simulation", o->simulations, "Trajectories of the simulations (H5MD)");
  former_option(verb, "--frames", "--stack");
  verb.add_option("--stack", o->stacks,
                  "Stacks of the experiments, in the same order, to show in the report; default: the stacks "
                  "that were tracked, if they are still available");
  verb.add_option("--sweep", o->sweeps,
                  "Collected results of sweeps (JSON), whose points and onsets are added to the comparison");
  writes(common, verb, verb.add_option("-o,--output", o->output, "Folder for the report")->required(),
         analysis::report_folder());
  add_comparing_flags(verb, o->flags);
  verb.add_flag("--trust-stated-drive", o->trust_stated_drive,
                "Use the drive that the experiments' cells state, even if the plate or the bed in the film "
                "moves differently");
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
