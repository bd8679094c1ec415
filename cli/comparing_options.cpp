#include "cli/comparing_options.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "core/error.hpp"

namespace twincell::cli {

void add_comparing_flags(CLI::App& verb, ComparingFlags& flags) {
  verb.add_option("--discard", flags.options.analysis.discard_cycles,
                  "Number of cycles skipped at the start of each trajectory")
      ->capture_default_str();
  verb.add_option("--s-b", flags.s_b,
                  "Form of eq. B4 (Fortini & Huang 2015) for s_b: variance (standard deviation over the "
                  "phases), about_rest (rms about the height at rest) or as_printed (rms of the height)")
      ->check(CLI::IsMember({"variance", "about_rest", "as_printed"}))
      ->capture_default_str();
  verb.add_option("--cutoff", flags.options.analysis.neighbour_cutoff,
                  "Largest distance between neighbours, sigma; default: 1.2, for experiments 1.3");
  verb.add_option("--tolerance", flags.options.tolerance,
                  "Largest relative difference of Gamma between runs that are matched, 0 to 0.5")
      ->capture_default_str();
  verb.add_option("--camera", flags.camera_file,
                  "CAMERA.toml of the synthetic camera that renders the simulation (docs/camera.md); "
                  "default: scale and noise of the experiment");
  verb.add_flag("--no-film", flags.no_film,
                "Do not render and track the simulations; the effect of camera and tracking on the results "
                "then remains unknown");
}

void resolve(ComparingFlags& flags, const Common& common) {
  require_range({.file = {}, .key = "--tolerance"}, flags.options.tolerance, 0, 0.5);
  flags.options.analysis.s_b = s_b_named(flags.s_b);
  flags.options.film = !flags.no_film;
  flags.options.threads = common.n_threads();
  if (!flags.camera_file.empty()) flags.options.camera = read_camera(flags.camera_file);
  if (flags.options.camera && common.seed) flags.options.camera->seed = *common.seed;
}

ProgressOf progress_bars(const Common& common) {
  return [&common](const std::string& stage) -> std::unique_ptr<Progress> {
    return std::make_unique<ProgressBar>(common, stage);
  };
}

void compare_and_report(const Common& common, const ComparingOptions& options,
                        const std::filesystem::path& folder, nlohmann::json said,
                        const std::string& said_text) {
  std::vector<std::string> notes;
  const Comparison comparison = compare_runs(options, progress_bars(common), notes);
  for (const std::string& sentence : notes) note(common, sentence);
  Provenance provenance = common.provenance();
  for (const auto* files : {&options.experiments, &options.simulations, &options.sweeps})
    provenance.inputs.insert(provenance.inputs.end(), files->begin(), files->end());
  const std::string origin = provenance.to_json();
  {
    ProgressBar progress(common, "figures");
    write_report(folder, comparison, origin, progress);
  }
  const std::string report = (folder / "report.html").string();
  said.update(nlohmann::json::parse(comparison_json(comparison)));
  said["notes"] = notes;
  said["report"] = report;
  said["provenance"] = nlohmann::json::parse(origin);
  print_result(common, said, said_text + comparison_text(comparison) + "report: " + report + "\n");
}

}  // namespace twincell::cli
