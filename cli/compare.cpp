#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/phase_diagram.hpp"
#include "analysis/report.hpp"
#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"

namespace twincell::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> experiments;
  std::vector<std::string> simulations;
  std::string output;
  std::string s_b = "variance";
  double tolerance = 0.02;
  AnalysisOptions analysis;
};

void run(const Common& common, const CompareOptions& options) {
  if (options.experiments.empty() && options.simulations.empty())
    throw ConfigError({.file = {}, .key = "compare"},
                      "there is nothing to compare: give --experiment and --simulation trajectories");
  require_range({.file = {}, .key = "--tolerance"}, options.tolerance, 0, 0.5);
  { const AtomicPath probe(options.output, AtomicPath::Kind::folder); }  // found before the work, not after
  Provenance provenance = common.provenance();
  std::vector<Run> runs;
  const auto add = [&](const std::vector<std::string>& files, Side side) {
    for (const std::string& file : files) {
      const H5mdReader trajectory(file);
      ProgressBar progress(common, file);
      runs.push_back(analyze_run(trajectory, side, options.analysis, progress));
      provenance.inputs.emplace_back(file);
    }
  };
  add(options.experiments, Side::experiment);
  add(options.simulations, Side::simulation);
  const auto matches = match_runs(runs, options.tolerance);

  const std::filesystem::path folder = options.output;
  {
    ProgressBar progress(common, "figures");
    write_report(folder, runs, matches, provenance.to_json(), progress);
  }
  const std::string report = (folder / "report.html").string();
  nlohmann::json document = nlohmann::json::parse(comparison_json(runs, matches));
  document["report"] = report;
  document["provenance"] = nlohmann::json::parse(provenance.to_json());
  print_result(common, document, comparison_text(runs, matches) + "report: " + report + "\n");
}

}  // namespace

void add_compare(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "compare",
      "experiment and simulation side by side: phase diagram, figures, one report",
      "twincell compare --experiment exp_15.h5 exp_20.h5 --simulation sim_15.h5 sim_20.h5 -o report");
  auto options = std::make_shared<CompareOptions>();
  verb.add_option("--experiment", options->experiments, "trajectories of the experiment (H5MD)");
  verb.add_option("--simulation", options->simulations, "trajectories of the simulation (H5MD)");
  verb.add_option("-o,--output", options->output, "folder of the report; replaced as a whole")->required();
  verb.add_option("--discard", options->analysis.discard_cycles, "cycles left out at the beginning")
      ->capture_default_str();
  verb.add_option("--s-b", options->s_b, "reading of eq. B4")
      ->check(CLI::IsMember({"variance", "about_rest", "as_printed"}))
      ->capture_default_str();
  verb.add_option("--cutoff", options->analysis.neighbour_cutoff,
                  "neighbour distance, sigma (1.2; experiments 1.3)");
  verb.add_option("--tolerance", options->tolerance,
                  "relative difference of Gamma within which runs belong together")
      ->capture_default_str();
  verb.callback([&common, options] {
    options->analysis.s_b = s_b_named(options->s_b);
    run(common, *options);
  });
}

}  // namespace twincell::cli
