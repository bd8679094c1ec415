// twincell measure SCENE.toml: simulates a scene and analyses it during the run.

#include "sweep/measure.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/observable/results.hpp"
#include "cli/output.hpp"
#include "cli/plan_text.hpp"
#include "cli/results_summary.hpp"
#include "cli/scene_notes.hpp"
#include "cli/verb.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::cli {

namespace {

using nlohmann::json;

/// Range of W in which a bed can stay solid or boiling, as it started, for hundreds of cycles (V. H38).
constexpr double kLowestBistable = 1, kHighestBistable = 2.1;
/// A bed that is first shaken at twice the amplitude starts boiling.
constexpr const char* kFluidised = "drive.schedule=[[0, 2], [20, 2], [30, 1]]";

struct MeasureOptions {
  std::string scene, output;
  std::vector<std::string> assignments;
  analysis::AnalysisOptions analysis;
  bool both_starts = false;
};

struct Run {
  sweep::Measured measured;
  json about;
  std::string provenance;
};

Run run_once(const MeasureOptions& options, sim::Scene scene, const std::string& start,
             const Common& common) {
  protect_named_inputs(common, scene.named_files());
  sweep::require_one_drive(scene);
  note_units(common, scene);
  ProgressBar placing(common, "placing beads");
  sim::RunState state = sim::placed(scene, placing);
  json provenance = json::parse(scene_provenance(common, scene, state.beads, {options.scene}));
  const double w = scene.g() > 0 ? scene.drive.k_m() : std::nan("");
  if (!options.both_starts && scene.g() > 0 && w > kLowestBistable && w < kHighestBistable)
    note(common,
         fmt::format("at W = {:.4g}, just above 1, a bed can stay in the state in which it started for "
                     "hundreds of cycles; --both-starts runs it from rest and from a boiling bed.",
                     w));
  sim::Simulation run(std::move(scene), std::move(state), sim::SolverKind::best, common.threads);
  ProgressBar progress(common, "measuring");
  Run r{.measured = sweep::measure(run, options.analysis, options.scene, progress),
        .about = {},
        .provenance = {}};
  const sweep::Measured& m = r.measured;
  for (const std::string& warning : m.warnings) note(common, warning);
  r.about = {{"start", start}, {"cycles", m.cycles}, {"discarded", run.scene().discard}};
  if (std::isfinite(w)) r.about["w"] = w;
  if (m.precise) r.about["until"] = {{"reached", *m.precise}, {"text", m.until}};
  if (m.rest_height) r.about["rest_height"] = *m.rest_height;
  if (m.contact_fraction) r.about["contact_fraction"] = *m.contact_fraction;
  provenance["run"] = r.about;
  r.provenance = json_text(provenance);
  return r;
}

std::string as_text(const Run& run, bool verbose, bool requested) {
  const json& about = run.about;
  std::string s = fmt::format("start: {}; {} after {} discarded\n", about["start"].get<std::string>(),
                              plural(about["cycles"].get<long>(), "cycle"), about["discarded"].get<long>());
  if (about.contains("w")) s += fmt::format("W = {:.6g}\n", about["w"].get<double>());
  if (about.contains("until")) s += about["until"]["text"].get<std::string>() + "\n";
  if (about.contains("rest_height"))
    s += fmt::format("at rest on the plate the height of the centre of mass is {:.6g} sigma\n",
                     about["rest_height"].get<double>());
  if (about.contains("contact_fraction"))
    s += fmt::format("beads are in contact for {:.3g} of the time{}\n",
                     about["contact_fraction"].get<double>(),
                     about["contact_fraction"].get<double>() > 0.1
                         ? ", more than the 0.1 up to which they behave like hard beads"
                         : "");
  return s + (verbose ? analysis::results_text(run.measured.results)
                      : results_summary(run.measured.results, requested));
}

/// Compares T_z of both starts: the starts agree if their intervals overlap.
std::string compared(const Run& rest, const Run& boiling) {
  const auto t_z = [](const Run& r) { return analysis::seek_result(r.measured.results, "T_z"); };
  const analysis::Result *a = t_z(rest), *b = t_z(boiling);
  if (a == nullptr || b == nullptr || !a->interval || !b->interval)
    return "the starts cannot be compared: T_z does not have an interval for both";
  const bool apart = a->interval->low > b->interval->high || b->interval->low > a->interval->high;
  return fmt::format("T_z from rest {:.5g}, from a boiling bed {:.5g}: {}", a->value(), b->value(),
                     apart ? "the result depends on the start" : "both starts end in one state");
}

void run(const MeasureOptions& options, const Common& common) {
  analysis::require_read(options.analysis);
  const std::vector<std::string> assignments = with_seed(options.assignments, common);
  sim::Scene scene = sim::read_scene(options.scene, assignments);
  note_seed(common, scene, assignments);
  const Run first = run_once(options, std::move(scene), "as in the scene", common);
  if (!options.output.empty())
    analysis::write_results(options.output, first.measured.results, first.provenance);
  json document = first.about;
  document["results"] = json::parse(analysis::results_json(first.measured.results));
  document["provenance"] = json::parse(first.provenance);
  std::string text = as_text(first, common.verbose, !options.analysis.only.empty());
  if (options.both_starts) {
    std::vector<std::string> boiling = assignments;
    boiling.emplace_back(kFluidised);
    const Run second = run_once(options, sim::read_scene(options.scene, boiling),
                                "boiling: twice the amplitude for 20 cycles, then reduced within 10", common);
    document["other_start"] = second.about;
    document["other_start"]["results"] = json::parse(analysis::results_json(second.measured.results));
    document["starts"] = compared(first, second);
    text += "\n" + as_text(second, common.verbose, !options.analysis.only.empty()) + "\n" +
            document["starts"].get<std::string>() + "\n";
  }
  print_result(common, document, text);
}

}  // namespace

void add_measure(CLI::App& program, Common& common) {
  auto options = std::make_shared<MeasureOptions>();
  CLI::App& verb = add_verb(program, common, "measure",
                            "Simulate a scene and analyse it during the run, until a mean reaches the "
                            "precision that [until] requests. Prints the results; no frames are stored.",
                            "twincell measure gas.toml --only T_z,delta_h_cm --set until.quantity=T_z "
                            "--set until.relative_error=0.02 --set time.cycles=20000");
  takes_seed(verb, common);
  has_details(verb, "all results, lists and absent ones included, and how each is computed");
  verb.add_option("scene", options->scene, "Scene file (TOML, docs/scene.md)")->required();
  writes(common, verb,
         verb.add_option("-o,--output", options->output, "Also write the results to this HDF5 file"),
         Product::results());
  verb.add_option("--set", options->assignments,
                  "Set a key of the scene, as section.key=value; overrides the file; may be repeated")
      ->take_all();
  verb.add_option("--only", options->analysis.only,
                  "Names of the results to compute, comma separated; fewer take less time; default: all")
      ->delimiter(',');
  verb.add_option("--rest-height", options->analysis.rest_height,
                  "h_cm of the bed at rest, sigma; default: measured on the settled bed");
  verb.add_flag(
      "--both-starts", options->both_starts,
      "Run the scene a second time from a boiling bed, and report whether the result depends on the start");
  verb.callback([options, &common] { run(*options, common); });
}

}  // namespace twincell::cli
