#include "analysis/report/report_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/escape.hpp"

namespace twincell::analysis {

namespace {

std::string csv_number(double v) {
  return std::isfinite(v) ? fmt::format("{:.9g}", v) : std::string();
}

}  // namespace

double value_of(const Result* r) {
  return r != nullptr ? r->value() : std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> scalar_names(const std::vector<Run>& runs) {
  std::vector<std::string> names;
  for (const std::string& name : result_names()) {
    const auto is_number = [&](const Run& run) {
      const Result* r = seek_result(run.results, name);
      return r != nullptr && r->present() && r->shape.empty() && r->text.empty();
    };
    if (std::any_of(runs.begin(), runs.end(), is_number)) names.push_back(name);
  }
  return names;
}

std::string runs_csv(const std::vector<Run>& runs) {
  const auto names = scalar_names(runs);
  std::string text = "side,run,start,gamma,gamma_error,k_m,k_m_error,n_l,n_beads,n_frames,phase";
  for (const std::string& name : names) text += fmt::format(",{0},{0}_low,{0}_high", name);
  text += "\n";
  for (const Run& run : runs) {
    const double by_drive = run.drive_error().value_or(std::numeric_limits<double>::quiet_NaN());
    text += fmt::format("{},{},{},{:.9g},{},{:.9g},{},{:.9g},{},{},{}", side_name(run.side),
                        csv_field(run.name), csv_field(run.start), run.gamma,
                        csv_number(by_drive * run.gamma), run.k_m, csv_number(2 * by_drive * run.k_m),
                        run.n_l, run.n_beads, run.n_frames, phase_name(run.phase));
    for (const std::string& name : names) {
      const Result* r = seek_result(run.results, name);
      text += fmt::format(",{}", csv_number(value_of(r)));
      text += r != nullptr && r->interval ? fmt::format(",{:.9g},{:.9g}", r->interval->low, r->interval->high)
                                          : ",,";
    }
    text += "\n";
  }
  return text;
}

std::string differences_csv(const Comparison& c) {
  std::string text =
      "gamma,n_l,number,unit,experiment,experiment_error,simulation,simulation_error,difference,filmed,"
      "camera,statistics,seeds,tracers,scale,drive,defects,remainder,error,attribution\n";
  const auto part = [](const std::optional<double>& v) {
    return csv_number(v.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  for (const Difference& d : c.differences)
    text += fmt::format(
        "{:.9g},{:.9g},{},{},{:.9g},{},{:.9g},{},{:.9g},{},{},{},{},{},{},{},{},{:.9g},{},{}\n",
        c.matches[d.match].gamma, c.matches[d.match].n_l, d.quantity, d.unit, d.experiment.value,
        part(d.experiment.error), d.simulation.value, part(d.simulation.error), d.difference(),
        part(d.filmed), part(d.camera), part(d.statistics), part(d.seeds), part(d.tracers), part(d.scale),
        part(d.drive), part(d.defects), d.remainder(), part(d.error()), csv_field(d.attribution()));
  return text;
}

std::string series_csv(const std::vector<Run>& runs, const std::string& name, const std::string& index) {
  std::string text = fmt::format("side,run,gamma,{},{}\n", index, name);
  for (const Run& run : runs) {
    const Result& r = find_result(run.results, name);
    for (std::size_t i = 0; i < r.values.size(); ++i)
      text += fmt::format("{},{},{:.9g},{},{}\n", side_name(run.side), csv_field(run.name), run.gamma, i,
                          std::isfinite(r.values[i]) ? fmt::format("{:.9g}", r.values[i]) : "");
  }
  return text;
}

}  // namespace twincell::analysis
