#include "analysis/report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <nlohmann/json.hpp>

#include "analysis/observable/results.hpp"
#include "analysis/report/boundary_figure.hpp"
#include "analysis/report/conclusion.hpp"
#include "analysis/report/figure.hpp"
#include "analysis/report/phase_diagram_figure.hpp"
#include "analysis/report/report_csv.hpp"
#include "analysis/report/report_page.hpp"
#include "analysis/report/run_figures.hpp"
#include "analysis/report/snapshots_figure.hpp"
#include "analysis/runs/match_verdict.hpp"
#include "core/atomic_file.hpp"
#include "core/json_text.hpp"

namespace twincell::analysis {

namespace {

std::string conclusion(const Comparison& c) {
  return fmt::format("{}", fmt::join(conclusion_sentences(c), " "));
}

nlohmann::json differences_json(const std::vector<Difference>& differences,
                                const std::vector<Match>& matches) {
  nlohmann::json list = nlohmann::json::array();
  const auto measured = [&](const Measured& m) {
    return nlohmann::json{{"value", m.value}, {"error", number_or_null(m.error)}};
  };
  for (const Difference& d : differences)
    list.push_back({{"gamma", matches[d.match].gamma},
                    {"n_l", matches[d.match].n_l},
                    {"number", d.quantity},
                    {"unit", d.unit},
                    {"experiment", measured(d.experiment)},
                    {"simulation", measured(d.simulation)},
                    {"difference", d.difference()},
                    {"filmed", number_or_null(d.filmed)},
                    {"camera", number_or_null(d.camera)},
                    {"statistics", number_or_null(d.statistics)},
                    {"seeds", number_or_null(d.seeds)},
                    {"tracers", number_or_null(d.tracers)},
                    {"scale", number_or_null(d.scale)},
                    {"drive", number_or_null(d.drive)},
                    {"defects", number_or_null(d.defects)},
                    {"remainder", d.remainder()},
                    {"error", number_or_null(d.error())},
                    {"attribution", d.attribution()}});
  return list;
}

nlohmann::json boundaries_json(const std::vector<PhaseBoundary>& boundaries) {
  nlohmann::json list = nlohmann::json::array();
  for (const PhaseBoundary& b : boundaries)
    list.push_back({{"onset", phase_name(b.onset)},
                    {"of", boundary_of(b)},
                    {"n_l", b.n_l},
                    {"gamma", number_or_null(b.gamma())},
                    {"half_width", number_or_null(b.half_width())},
                    {"below", number_or_null(b.below)},
                    {"above", number_or_null(b.above)},
                    {"runs", b.n_runs},
                    {"overlap", b.overlap}});
  return list;
}

/// Phases of both sides at each drive strength, and the onsets.
std::string phases_text(const Comparison& c) {
  std::string text;
  if (!c.matches.empty())
    text = fmt::format("{:>7}  {:>7}  {:>6}  {:<22}  {:<22}  {}\n", "Gamma", "K_m", "N_l", "experiment",
                       "simulation", "verdict");
  for (const Match& match : c.matches) {
    const Run& any =
        c.runs[match.experiments.empty() ? match.simulations.front() : match.experiments.front()];
    text += fmt::format("{:>7.3f}  {:>7.3f}  {:>6.2f}  {:<22}  {:<22}  {}\n", match.gamma, any.k_m, match.n_l,
                        phases_of(c.runs, match.experiments), phases_of(c.runs, match.simulations),
                        verdict_word(c.runs, match));
  }
  for (const PhaseBoundary& b : c.boundaries)
    text += fmt::format("onset of {}, {}, N_l = {:.3g}: Gamma {}\n", onset_name(b.onset), boundary_of(b),
                        b.n_l, boundary_text(b));
  return text;
}

}  // namespace

std::string comparison_text(const Comparison& c) {
  return conclusion(c) + "\n" + phases_text(c) + differences_text(c.differences, c.matches);
}

std::string comparison_summary(const Comparison& c) {
  return fmt::format("{}\n", fmt::join(conclusion_sentences(c), "\n")) + phases_text(c) +
         real_differences_text(c.differences, c.matches);
}

std::string comparison_json(const Comparison& c) {
  nlohmann::json document;
  document["conclusion"] = conclusion(c);
  document["runs"] = nlohmann::json::array();
  for (const Run& run : c.runs)
    document["runs"].push_back({{"side", side_name(run.side)},
                                {"run", run.name},
                                {"start", run.start},
                                {"gamma", number_or_null(run.gamma)},
                                {"k_m", number_or_null(run.k_m)},
                                {"n_l", number_or_null(run.n_l)},
                                {"n_beads", run.n_beads},
                                {"n_frames", run.n_frames},
                                {"phase", phase_name(run.phase)},
                                {"results", nlohmann::json::parse(results_json(run.results))}});
  document["matches"] = nlohmann::json::array();
  const auto names = [&](const std::vector<std::size_t>& members) {
    nlohmann::json list = nlohmann::json::array();
    for (const std::size_t i : members)
      list.push_back({{"run", c.runs[i].name}, {"phase", phase_name(c.runs[i].phase)}});
    return list;
  };
  for (const Match& match : c.matches)
    document["matches"].push_back({{"gamma", match.gamma},
                                   {"experiments", names(match.experiments)},
                                   {"simulations", names(match.simulations)},
                                   {"verdict", verdict_word(c.runs, match)}});
  document["boundaries"] = boundaries_json(c.boundaries);
  document["differences"] = differences_json(c.differences, c.matches);
  document["notes"] = c.notes;
  return json_text(document);
}

void write_report(const std::filesystem::path& folder, const Comparison& c,
                  const std::string& provenance_json, Progress& progress) {
  AtomicPath output(folder, report_folder());
  const std::filesystem::path figure_folder = output.part() / "figures";
  std::filesystem::create_directories(figure_folder);

  std::vector<Figure> figures;
  if (!c.runs.empty())
    figures = {phase_strip_figure(c.runs), phase_diagram_figure(c.runs, c.boundaries),
               thresholds_figure(c.runs), s_k_figure(c.runs), s_j_figure(c.runs)};
  if (!c.boundaries.empty() || !c.sweep.empty()) figures.push_back(boundary_figure(c));
  for (std::size_t m = 0; m < c.matches.size(); ++m)
    figures.push_back(snapshots_figure(c.runs, c.matches[m], fmt::format("snapshots_{}", m + 1)));
  for (std::size_t i = 0; i < figures.size(); ++i) {
    draw(figures[i], figure_folder);
    progress.update(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(figures.size()));
  }
  write_text_file(output.part() / "runs.csv", runs_csv(c.runs));
  write_text_file(output.part() / "differences.csv", differences_csv(c));
  write_text_file(output.part() / "series_s_k.csv", series_csv(c.runs, "s_k", "k"));
  write_text_file(output.part() / "series_s_j.csv", series_csv(c.runs, "s_j", "j"));
  write_text_file(output.part() / "phases.txt", comparison_text(c));
  write_text_file(output.part() / "results.json", comparison_json(c) + "\n");
  write_text_file(output.part() / "provenance.json", provenance_json + "\n");
  write_text_file(output.part() / "report.html", report_page(c, figures, figure_folder, provenance_json));
  output.commit();
}

}  // namespace twincell::analysis
