#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/observable.hpp"
#include "analysis/results.hpp"
#include "analysis/spatial_figures.hpp"
#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/h5md_file.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"

namespace twincell::cli {
namespace {

struct AnalyzeOptions {
  std::string trajectory;
  std::string output;
  std::string figures;
  std::string s_b = "variance";
  std::string neighbours = "cutoff";
  AnalysisOptions analysis;
};

void run(const Common& common, const AnalyzeOptions& options) {
  const H5mdReader trajectory(options.trajectory);
  // An unwritable place is found before the work, not after.
  if (!options.output.empty()) AtomicPath{options.output};
  if (!options.figures.empty()) AtomicPath(options.figures, AtomicPath::Kind::folder);
  ProgressBar progress(common, "analyze");
  const auto results = analyze(trajectory, options.analysis, progress);

  Provenance provenance = common.provenance();
  provenance.inputs = {options.trajectory};
  const std::string provenance_json = provenance.to_json();
  if (!options.output.empty()) write_results(options.output, results, provenance_json);
  if (!options.figures.empty()) {
    AtomicPath folder(options.figures, AtomicPath::Kind::folder);
    std::filesystem::create_directories(folder.part());
    for (const Figure& figure : spatial_figures(results, trajectory, options.analysis))
      draw(figure, folder.part());
    folder.commit();
  }

  nlohmann::json document;
  document["results"] = nlohmann::json::parse(results_json(results));
  document["provenance"] = nlohmann::json::parse(provenance_json);
  print_result(common, document, results_text(results));
}

}  // namespace

void add_analyze(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "analyze",
      "observables of a trajectory: phase, s_b, s_c, order, defects, slip, convection, profiles, temperature",
      "twincell analyze sim.h5 --discard 10 -o results.h5");
  auto options = std::make_shared<AnalyzeOptions>();
  verb.add_option("trajectory", options->trajectory, "trajectory (H5MD)")->required();
  verb.add_option("-o,--output", options->output, "write the results to this HDF5 file too");
  verb.add_option("--figures", options->figures,
                  "draw the lattice, the convection field, the profiles and the defects into this folder");
  verb.add_option("--discard", options->analysis.discard_cycles, "cycles left out at the beginning")
      ->capture_default_str();
  verb.add_option("--cycles", options->analysis.cycles, "cycles used after those, N_f (0: all)")
      ->capture_default_str();
  verb.add_option("--tracers", options->analysis.tracers, "ids of the tracers, comma separated")
      ->delimiter(',');
  verb.add_option("--tracer-band", options->analysis.tracer_band,
                  "as tracers all beads that begin LOW,HIGH sigma above the plate")
      ->delimiter(',')
      ->type_name("LOW,HIGH");
  verb.add_option("--s-b", options->s_b, "reading of eq. B4")
      ->check(CLI::IsMember({"variance", "about_rest", "as_printed"}))
      ->capture_default_str();
  verb.add_option("--only", options->analysis.only, "results wanted, comma separated")->delimiter(',');
  verb.add_option("--neighbours", options->neighbours, "whose bonds make q6, psi6, psi4, orientation, grains")
      ->check(CLI::IsMember({"cutoff", "delaunay", "voronoi"}))
      ->capture_default_str();
  verb.add_option("--cell-radius", options->analysis.cell_radius,
                  "size of Voronoi cells, sigma: farther from every bead there is a hole")
      ->capture_default_str();
  verb.add_option("--field-cell", options->analysis.field_cell,
                  "side of the cells in which displacements per cycle are averaged, sigma")
      ->capture_default_str();
  verb.add_option("--rest-height", options->analysis.rest_height,
                  "h_cm of the bed at rest, sigma, from which delta_h_cm is taken");
  verb.add_option("--cutoff", options->analysis.neighbour_cutoff,
                  "neighbour distance, sigma (1.2; experiments 1.3)");
  verb.callback([&common, options] {
    options->analysis.s_b = s_b_named(options->s_b);
    options->analysis.neighbours = neighbour_rule_named(options->neighbours);
    run(common, *options);
  });
}

}  // namespace twincell::cli
