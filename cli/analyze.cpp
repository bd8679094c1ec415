#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/motion/centre_of_mass.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/observable/results.hpp"
#include "analysis/observable/short_periods.hpp"
#include "analysis/observable/timed_analysis.hpp"
#include "analysis/report/spatial_figures.hpp"
#include "analysis/report/windows_figure.hpp"
#include "analysis/runs/pooling.hpp"
#include "analysis/runs/windows.hpp"
#include "cli/output.hpp"
#include "cli/profile.hpp"
#include "cli/results_summary.hpp"
#include "cli/trajectory_notes.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/plate.hpp"
#include "trajectory/tracking_record.hpp"

namespace twincell::cli {
namespace {

struct AnalyzeOptions {
  std::vector<std::string> trajectories;
  std::string output, table;
  std::string figures;
  std::string rest_height;
  std::string s_b = "variance";
  std::string neighbours = "cutoff";
  analysis::AnalysisOptions analysis;
  std::int64_t window = 0;  ///< cycles; 0: the run as a whole
  bool profile = false;
};

Product window_table() {
  return Product::text("a table of windows", "first_cycle,cycles,gamma_begin,");
}

Product figure_folder() {
  return Product::whole_folder("the figures of an analysis");
}

void draw_into(const std::vector<analysis::Figure>& figures, const std::string& place) {
  AtomicPath folder(place, figure_folder());
  for (const analysis::Figure& figure : figures) analysis::draw(figure, folder.part());
  folder.commit();
}

/// \throws ConfigError if the bed at rest has another number of beads (10 %) or another width (2 %) than one
/// of the runs
void require_same_bed(const H5mdReader& rest, const std::vector<std::string>& runs) {
  constexpr double kBeads = 0.1, kWidth = 0.02;
  const auto differ = [](double a, double b, double share) {
    return std::abs(a - b) > share * std::max(a, b);
  };
  Frame at_rest, frame;
  rest.read(0, at_rest);
  for (const std::string& name : runs) {
    const H5mdReader run(name);
    run.read(0, frame);
    const auto n = static_cast<double>(at_rest.n_present()), m = static_cast<double>(frame.n_present());
    const double w = rest.info().box.size().x(), v = run.info().box.size().x();
    if (differ(n, m, kBeads) || differ(w, v, kWidth))
      throw ConfigError({.file = rest.name(), .key = "--rest-height"},
                        fmt::format("is the bed of {:g} beads in a width of {:.4g}; {} has {:g} in {:.4g}.",
                                    n, w, name, m, v));
  }
}

/// Returns the number in `said`, or the mean height of the centre of mass above the plate in the trajectory
/// that `said` names, which must show a bed at rest.
/// \param runs trajectories whose beds it is the reference of
double rest_height_of(const std::string& said, const std::vector<std::string>& runs) {
  double number = 0;
  const bool has_plus = said.starts_with('+') && !said.starts_with("+-");  // which from_chars does not read
  const char *begin = said.data() + (has_plus ? 1 : 0), *end = said.data() + said.size();
  if (const auto [last, error] = std::from_chars(begin, end, number); error == std::errc() && last == end)
    return number;
  const H5mdReader trajectory(said);
  require_same_bed(trajectory, runs);
  double sum = 0, low = INFINITY, high = -INFINITY;
  Frame frame;
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    throw_if_cancelled();
    trajectory.read(f, frame);
    const auto plate = plate_height(trajectory.info(), frame);
    const double height = centre_of_mass_height(frame, trajectory.info().mass) - plate.value_or(std::nan(""));
    if (!std::isfinite(height))
      throw InputError({.file = said, .key = "--rest-height"},
                       fmt::format("frame {} has no bead or no plate height", f));
    sum += height;
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (trajectory.n_frames() == 0 || high - low > analysis::kHalfPixelOfPaper1)
    throw InputError({.file = said, .key = "--rest-height"},
                     fmt::format("is not a bed at rest: its centre of mass moves by {:.3g} sigma relative to "
                                 "the plate in {} frames; the limit is {:.3g}",
                                 high - low, trajectory.n_frames(), analysis::kHalfPixelOfPaper1));
  return sum / static_cast<double>(trajectory.n_frames());
}

nlohmann::json as_json(const std::vector<analysis::Window>& windows) {
  nlohmann::json list = nlohmann::json::array();
  for (const analysis::Window& w : windows) {
    nlohmann::json one = {{"first_cycle", w.first_cycle}, {"cycles", w.cycles}};
    if (w.drive) {
      const auto& [begin, end] = *w.drive;
      one["gamma"] = {begin.gamma(), end.gamma()};
      one["omega"] = {begin.omega, end.omega};
      one["amplitude"] = {begin.amplitude, end.amplitude};
    }
    one["results"] = nlohmann::json::parse(analysis::results_json(w.results));
    list.push_back(std::move(one));
  }
  return list;
}

/// One line for each window: cycles, Gamma, omega, phase, then numbers.
std::string as_text(const std::vector<analysis::Window>& windows, const std::vector<std::string>& only) {
  std::vector<std::string> names;
  for (const std::string& name : analysis::names_of_numbers(windows)) {
    const bool usual = std::find(std::begin(analysis::kWindowNumbers), std::end(analysis::kWindowNumbers),
                                 name) != std::end(analysis::kWindowNumbers);
    if (name != "phase" && (only.empty() ? usual : true)) names.push_back(name);
  }
  const bool phase = analysis::seek_result(windows.front().results, "phase") != nullptr;
  std::string text = fmt::format("{:<13} {:<17} {:<17}", "cycles", "Gamma", "omega, 1/t0");
  if (phase) text += fmt::format(" {:<12}", "phase");
  for (const std::string& name : names) text += fmt::format(" {:>12}", name);
  const auto change = [](double begin, double end) {
    const std::string from = fmt::format("{:.4g}", begin), to = fmt::format("{:.4g}", end);
    return from == to ? from : from + " to " + to;
  };
  for (const analysis::Window& w : windows) {
    text += fmt::format("\n{:<13}", fmt::format("{} to {}", w.first_cycle, w.first_cycle + w.cycles - 1));
    if (w.drive)
      text += fmt::format(" {:<17} {:<17}", change((*w.drive)[0].gamma(), (*w.drive)[1].gamma()),
                          change((*w.drive)[0].omega, (*w.drive)[1].omega));
    else
      text += fmt::format(" {:<17} {:<17}", "not known", "not known");
    if (phase) {
      const analysis::Result& r = analysis::find_result(w.results, "phase");
      text += fmt::format(" {:<12}", r.present() ? r.text : "absent");
    }
    for (const std::string& name : names) {
      const analysis::Result& r = analysis::find_result(w.results, name);
      text += !r.present()     ? fmt::format(" {:>12}", "absent")
              : r.text.empty() ? fmt::format(" {:>12.5g}", r.value())
                               : fmt::format(" {:>12}", r.text);
    }
    while (text.back() == ' ') text.pop_back();
  }
  return text + '\n';
}

/// Notes a film whose drive is not the stated one: phases and heights of the plate are then wrong.
void note_drive(const Common& common, const TrajectorySource& trajectory) {
  if (const auto said = recorded_disagreement(trajectory.info()); said && !said->empty())
    note(common, fmt::format("{}: the stated drive does not fit the film: {}.", trajectory.name(), *said));
}

/// Notes beads whose diameter is not sigma, with which the default cutoff does not find the neighbours.
void note_cutoff(const Common& common, const TrajectorySource& trajectory,
                 const analysis::AnalysisOptions& options) {
  const std::vector<double>& radius = trajectory.info().radius;
  if (options.neighbour_cutoff || options.neighbours != analysis::NeighbourRule::cutoff || radius.empty())
    return;
  double sum = 0;
  std::size_t n = 0;
  for (const double r : radius)
    if (std::isfinite(r)) {
      sum += 2 * r;
      ++n;
    }
  constexpr double kMaxSizeSpread = 0.05;  // sizes of measured beads differ from sigma by a few percent
  const double diameter = n > 0 ? sum / static_cast<double>(n) : 1;
  if (std::abs(diameter - 1) <= kMaxSizeSpread) return;
  const double cutoff = analysis::neighbour_cutoff(trajectory.info(), options);
  note(common,
       fmt::format(
           "{}: the beads have a mean diameter of {:.3g} sigma, and neighbours are beads within {:g} sigma; "
           "results of order, defects and slip need --cutoff {:.3g}.",
           trajectory.name(), diameter, cutoff, cutoff * diameter));
}

/// A note on periods in which a bead meets several images of a neighbour, of which one counts.
void note_periods(const Common& common, const TrajectorySource& trajectory,
                  const analysis::AnalysisOptions& options) {
  for (const std::string& sentence : analysis::short_periods(trajectory.info(), options))
    note(common, fmt::format("{}: {}.", trajectory.name(), sentence));
}

/// Analyses a run in windows. The results go to a table, if one is requested.
void run_windows(const Common& common, const AnalyzeOptions& options) {
  const auto refuse = [](const char* option, const char* why) {
    throw ConfigError({.file = {}, .key = option}, why);
  };
  if (options.trajectories.size() > 1)
    refuse("--window-cycles", "divides one trajectory into windows; several were given.");
  if (options.profile) refuse("--profile", "measures one analysis; --window-cycles makes several.");
  if (!options.output.empty())
    refuse("--output",
           "is the results of a whole run; with --window-cycles, use --table FILE.csv or --json.");
  const H5mdReader trajectory(options.trajectories.front());
  note_trajectory(common, trajectory);
  note_drive(common, trajectory);
  note_cutoff(common, trajectory, options.analysis);
  note_periods(common, trajectory, options.analysis);
  std::vector<analysis::Window> windows;
  std::vector<analysis::CycleRange> left_out;
  {
    ProgressBar progress(common, "analyze");
    windows = analysis::analyze_windows(trajectory, options.analysis, options.window, progress, &left_out);
  }
  Provenance provenance = common.provenance();
  provenance.inputs.assign(options.trajectories.begin(), options.trajectories.end());
  std::string text = as_text(windows, options.analysis.only);
  for (const auto& [first, last] : left_out)
    text += first == last ? fmt::format("cycle {} fills no window and is left out\n", first)
                          : fmt::format("cycles {} to {} fill no window and are left out\n", first, last);
  if (!options.table.empty()) {
    write_text_file(options.table, analysis::windows_csv(windows), window_table());
    text += options.table + "\n";
  }
  if (!options.figures.empty()) {
    draw_into(analysis::windows_figures(windows, options.analysis.only), options.figures);
    text += options.figures + "\n";
  }
  print_result(common,
               {{"windows", as_json(windows)},
                {"left_out_cycles", left_out},
                {"provenance", nlohmann::json::parse(provenance.to_json())}},
               text);
}

void run(const Common& common, const AnalyzeOptions& options) {
  // Figures are of the bed, whatever results are requested.
  if (options.figures.empty()) analysis::require_read(options.analysis);
  if (options.window > 0) return run_windows(common, options);
  if (!options.table.empty())
    throw ConfigError({.file = {}, .key = "--table"}, "is a table of windows; give --window-cycles.");
  Profile profile(options.profile);
  std::vector<std::unique_ptr<H5mdReader>> readers;
  std::vector<const TrajectorySource*> trajectories;
  for (const std::string& file : options.trajectories) {
    readers.push_back(std::make_unique<H5mdReader>(file));
    trajectories.push_back(readers.back().get());
    if (readers.back()->n_frames() == 0)
      throw InputError({.file = file, .key = {}}, "the trajectory contains no frame");
  }
  for (const std::string& doubt : analysis::require_one_condition(trajectories)) note(common, doubt);
  for (const TrajectorySource* trajectory : trajectories) {
    note_trajectory(common, *trajectory);
    note_drive(common, *trajectory);
    note_cutoff(common, *trajectory, options.analysis);
    note_periods(common, *trajectory, options.analysis);
  }
  if (readers.size() > 1 && !options.figures.empty())
    throw ConfigError({.file = {}, .key = "--figures"},
                      fmt::format("draws one trajectory; {} were given", readers.size()));
  const std::vector<analysis::Result> results = analysis::analyze_together(
      trajectories.size(), options.analysis, [&](std::size_t i, const analysis::AnalysisOptions& of_run) {
        ProgressBar progress(common, trajectories.size() > 1 ? trajectories[i]->name() : "analyze");
        return analysis::analyze(*trajectories[i], of_run, progress, profile.times());
      });

  Provenance provenance = common.provenance();
  provenance.inputs.assign(options.trajectories.begin(), options.trajectories.end());
  const std::string provenance_json = provenance.to_json();
  if (!options.output.empty()) {
    const Stage writing(profile.times(), "writing");
    analysis::write_results(options.output, results, provenance_json);
  }
  if (!options.figures.empty()) {
    const Stage drawing(profile.times(), "figures");
    draw_into(analysis::spatial_figures(results, *readers.front(), options.analysis), options.figures);
  }

  nlohmann::json document;
  document["results"] = nlohmann::json::parse(analysis::results_json(results));
  if (trajectories.size() > 1) document["runs"] = options.trajectories;
  document["provenance"] = nlohmann::json::parse(provenance_json);
  std::string text = common.verbose ? analysis::results_text(results)
                                    : results_summary(results, !options.analysis.only.empty());
  profile.add_to(document, text, 1);
  print_result(common, document, text);
}

}  // namespace

void add_analyze(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(
      program, common, "analyze",
      "Compute the observables of a trajectory: phase, s_b, s_c, order, defects, slip, convection, profiles "
      "and granular temperature, with confidence intervals. Prints them; -o also writes them to a file.",
      "twincell analyze sim.h5 --discard 2 -o results.h5");
  has_details(verb, "all results, lists and absent ones included, and how each is computed");
  auto options = std::make_shared<AnalyzeOptions>();
  verb.add_option("trajectory", options->trajectories,
                  "Trajectory (H5MD); several that differ only by chance (seeds, repeats) are pooled, with "
                  "confidence intervals over the runs")
      ->required();
  writes(common, verb,
         verb.add_option("-o,--output", options->output, "Also write the results to this HDF5 file"),
         Product::results());
  writes(common, verb,
         verb.add_option("--figures", options->figures,
                         "Draw the lattice, the convection field, the profiles and the defects into this "
                         "folder, with --window-cycles the results against the drive; for one trajectory "
                         "only"),
         figure_folder());
  verb.add_option("--discard", options->analysis.discard_cycles, "Number of cycles skipped at the start")
      ->capture_default_str();
  verb.add_option("--cycles", options->analysis.cycles,
                  "Number of cycles analysed after the skipped ones, N_f; 0: all")
      ->capture_default_str();
  verb.add_option("--window-cycles", options->window,
                  "Analyse the run in windows of this number of cycles, each by itself; a run whose drive "
                  "changes (drive.ramp) needs it")
      ->check(CLI::Range(1, 1'000'000));
  writes(common, verb,
         verb.add_option("--table", options->table,
                         "With --window-cycles: also write the windows to this CSV file, one row each"),
         window_table());
  verb.add_option("--tracers", options->analysis.tracers,
                  "Identities of the tracers, comma separated; default: the marked tracers, otherwise the "
                  "line at mid-height")
      ->delimiter(',');
  verb.add_option(
          "--tracer-band", options->analysis.tracer_band,
          "Use as tracers all beads whose initial height above the plate is between LOW and HIGH, sigma")
      ->delimiter(',')
      ->type_name("LOW,HIGH");
  verb.add_option("--s-b", options->s_b,
                  "Form of eq. B4 (Fortini & Huang 2015) for s_b. " + help_of(analysis::kSbForms))
      ->check(CLI::IsMember(words_of(analysis::kSbForms)))
      ->capture_default_str();
  verb.add_option("--only", options->analysis.only,
                  "Names of the results to compute, comma separated; default: all")
      ->delimiter(',')
      ->type_name(kWord);
  verb.add_option("--neighbours", options->neighbours,
                  "Definition of neighbours for q6, psi6, psi4, orientation and grains. " +
                      help_of(analysis::kNeighbourRules))
      ->check(CLI::IsMember(words_of(analysis::kNeighbourRules)))
      ->capture_default_str();
  verb.add_option("--cell-radius", options->analysis.cell_radius,
                  "Largest distance from a bead that belongs to its Voronoi cell, sigma; points farther from "
                  "every bead count as a hole")
      ->capture_default_str();
  verb.add_option("--field-cell", options->analysis.field_cell,
                  "Side of the cells over which displacements per cycle are averaged, sigma")
      ->capture_default_str();
  verb.add_option("--rest-height", options->rest_height,
                  "Reference of delta_h_cm: h_cm of the bed at rest, sigma, or a trajectory of the bed at "
                  "rest; default: the first frame, if the bed is at rest there")
      ->type_name("SIGMA|FILE");
  verb.add_option("--cutoff", options->analysis.neighbour_cutoff,
                  "Largest distance between neighbours, sigma; default: 1.2, for experiments 1.3");
  add_profile_option(verb, options->profile);
  verb.callback([&common, options] {
    if (!options->rest_height.empty())
      options->analysis.rest_height = rest_height_of(options->rest_height, options->trajectories);
    options->analysis.s_b = analysis::s_b_named(options->s_b);
    options->analysis.neighbours = analysis::neighbour_rule_named(options->neighbours);
    run(common, *options);
  });
}

}  // namespace twincell::cli
