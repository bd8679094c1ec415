#include "cli/comparing_options.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/observable/observable.hpp"
#include "analysis/report/report.hpp"
#include "cli/output.hpp"
#include "core/error.hpp"

namespace twincell::cli {

void add_comparing_flags(CLI::App& verb, ComparingFlags& flags) {
  const OptionHeading heading(verb, "Analysis and comparison");
  verb.add_option("--discard", flags.discard_cycles,
                  "Number of cycles skipped at the start of each trajectory")
      ->capture_default_str();
  verb.add_option("--s-b", flags.s_b,
                  "Form of eq. B4 (Fortini & Huang 2015) for s_b. " + help_of(analysis::kSbForms))
      ->check(CLI::IsMember(words_of(analysis::kSbForms)))
      ->capture_default_str();
  verb.add_option("--cutoff", flags.neighbour_cutoff,
                  "Largest distance between neighbours, sigma; default: 1.2, for experiments 1.3");
  verb.add_option("--tolerance", flags.tolerance,
                  "Largest relative difference of Gamma between runs that are matched, 0 to 0.5")
      ->capture_default_str();
  verb.add_option("--camera", flags.camera_file,
                  "CAMERA.toml of the synthetic camera that renders the simulation (docs/camera.md); "
                  "default: scale and noise of the experiment");
  verb.add_flag("--no-film", flags.no_film,
                "Do not render and track the simulations; the effect of camera and tracking on the results "
                "then remains unknown");
}

twin::ComparingOptions comparing_options(const ComparingFlags& flags, const Common& common) {
  require_range({.file = {}, .key = "--tolerance"}, flags.tolerance, 0, 0.5);
  // Refused before the simulations, although the analysis checks it again.
  if (flags.neighbour_cutoff)
    require_range({.file = {}, .key = "--cutoff"}, *flags.neighbour_cutoff, 0, 5, true);
  twin::ComparingOptions options;
  options.analysis.discard_cycles = flags.discard_cycles;
  options.analysis.neighbour_cutoff = flags.neighbour_cutoff;
  options.analysis.s_b = analysis::s_b_named(flags.s_b);
  options.tolerance = flags.tolerance;
  options.film = !flags.no_film;
  options.threads = common.n_threads();
  if (!flags.camera_file.empty()) options.camera = imaging::read_camera(flags.camera_file);
  if (options.camera && common.seed) options.camera->seed = *common.seed;
  return options;
}

analysis::Comparison compare_sides(const Common& common, const twin::ComparingOptions& options) {
  analysis::Comparison comparison = twin::compare_runs(options, progress_bars(common));
  for (const std::string& sentence : comparison.notes) note(common, sentence);
  return comparison;
}

void report_comparison(const Common& common, const twin::ComparingOptions& options,
                       const analysis::Comparison& comparison, const std::filesystem::path& folder,
                       nlohmann::json result, const std::string& result_text) {
  Provenance provenance = common.provenance();
  for (const auto* files : {&options.experiments, &options.simulations, &options.sweeps})
    provenance.inputs.insert(provenance.inputs.end(), files->begin(), files->end());
  const std::string origin = provenance.to_json();
  {
    ProgressBar progress(common, "figures");
    analysis::write_report(folder, comparison, origin, progress);
  }
  const std::string report = (folder / "report.html").string();
  result.update(nlohmann::json::parse(analysis::comparison_json(comparison)));
  result["report"] = report;
  result["provenance"] = nlohmann::json::parse(origin);
  print_result(
      common, result,
      (common.verbose ? analysis::comparison_text(comparison) : analysis::comparison_summary(comparison)) +
          result_text + "report: " + report + "\n");
}

}  // namespace twincell::cli
