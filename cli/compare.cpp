// twincell compare: both sides in one report.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "calibration/drive/plate_drive.hpp"
#include "cli/comparing_options.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {
namespace {

struct CompareOptions {
  std::string output;
  ComparingFlags flags;
  bool trust_stated_drive = false;
};

/// By what the film shows another drive than the experiment states, as one clause: as `track` saw it, else as
/// the beads show it.
std::string drive_disagreement(const H5mdReader& experiment) {
  const TrajectoryInfo& info = experiment.info();
  const auto tracking = nlohmann::json::parse(info.tracking_json, nullptr, false);
  if (tracking.is_object()) {
    if (tracking.contains("drive_disagreement"))
      return tracking["drive_disagreement"].is_string() ? tracking["drive_disagreement"].get<std::string>()
                                                        : "the stated drive does not fit the film";
    if (tracking.contains("drive_check")) return {};
  }
  if (info.source != "experiment" || !info.drive) return {};
  BedSteps bed(info);
  Frame frame;
  for (std::size_t f = 0; f < experiment.n_frames(); ++f) {
    experiment.read(f, frame);
    bed.append(frame);
  }
  return check_by_bed(bed, info, std::nullopt).disagreement;
}

/// Refuses experiments whose film does not show the drive that their cell states.
void require_drive_of_film(const std::vector<std::filesystem::path>& experiments) {
  for (const std::filesystem::path& file : experiments)
    if (const std::string clause = drive_disagreement(H5mdReader(file)); !clause.empty())
      throw ConfigError({.file = file.string(), .key = "drive"},
                        clause + "; correct the cell and track again, or say --trust-stated-drive.");
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
      "believe the drive that the experiments' cells state though the plate, or the bed, in the film moves "
      "otherwise");
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
