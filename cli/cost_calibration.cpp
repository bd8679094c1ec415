#include "cli/cost_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "calibration/accuracy/calibration_cost.hpp"
#include "core/json_text.hpp"

namespace twincell::cli {
namespace {

std::vector<std::string> names_of(const calibration::CalibrationCost& cost) {
  std::vector<std::string> names;
  for (const calibration::CalibrationPrecision& p : cost.numbers)
    if (std::find(names.begin(), names.end(), p.name) == names.end()) names.push_back(p.name);
  return names;
}

nlohmann::json as_json(const calibration::CalibrationCost& cost) {
  nlohmann::json d;
  for (const calibration::CalibrationPrecision& p : cost.numbers)
    d["numbers"].push_back({{"name", p.name},
                            {"unit", p.unit},
                            {"frames", p.frames},
                            {"standard_error", number_or_null(p.stated)},
                            {"actual_error", number_or_null(p.actual)}});
  for (const calibration::CalibrationTime& t : cost.times)
    d["times"].push_back(
        {{"frames", t.frames}, {"edges_s", t.edges_s}, {"fit_s", t.fit_s}, {"beads_s", t.beads_s}});
  return d;
}

std::string as_text(const calibration::CalibrationCost& cost) {
  std::string s = fmt::format(
      "Stated standard error; in brackets the actual error (value minus truth). Frames of {} x {} px with 12 "
      "x 6 beads of 14.3 px.\n\n",
      cost.width_px, cost.height_px);
  s += fmt::format("{:<26}", "frames");
  for (const calibration::CalibrationTime& t : cost.times) s += fmt::format("  {:>20}", t.frames);
  s += "\n";
  for (const std::string& name : names_of(cost)) {
    std::string unit, row;
    for (const calibration::CalibrationTime& t : cost.times) {
      const auto at = std::find_if(
          cost.numbers.begin(), cost.numbers.end(),
          [&](const calibration::CalibrationPrecision& p) { return p.name == name && p.frames == t.frames; });
      if (at == cost.numbers.end()) {
        row += fmt::format("  {:>20}", "-");
        continue;
      }
      unit = at->unit;
      row += fmt::format("  {:>20}", fmt::format("{:.2g} ({:+.1g})", at->stated, at->actual));
    }
    s += fmt::format("{:<26}{}  {}\n", name, row, unit);
  }
  const auto line = [&](const char* what, double calibration::CalibrationTime::*member) {
    s += fmt::format("{:<26}", what);
    for (const calibration::CalibrationTime& t : cost.times) s += fmt::format("  {:>20.3g}", t.*member);
    s += "  s\n";
  };
  line("time: edges", &calibration::CalibrationTime::edges_s);
  line("time: fits", &calibration::CalibrationTime::fit_s);
  line("time: beads", &calibration::CalibrationTime::beads_s);
  return s;
}

analysis::Figure figure(const calibration::CalibrationCost& cost) {
  analysis::Figure f{.name = "calibrating",
                     .title = "Accuracy of calibration against number of frames",
                     .width = 720,
                     .height = 460};
  analysis::figure_style::PlotAxis frames{.label = "frames", .logarithmic = true},
      error{.label = "standard error, in the unit of the key", .logarithmic = true};
  std::string clauses;
  int index = 0;
  for (const std::string& name : names_of(cost)) {
    f.data += fmt::format("# {}: frames, standard error\n", name);
    std::string unit;
    for (const calibration::CalibrationPrecision& p : cost.numbers)
      if (p.name == name && p.stated > 0) {
        f.data += fmt::format("{} {:.4g}\n", p.frames, p.stated);
        frames.show(p.frames);
        error.show(p.stated);
        unit = p.unit;
      }
    f.data += "\n\n";
    std::string title = name + (unit == "1" ? "" : ", " + unit);
    std::replace(title.begin(), title.end(), '_', ' ');
    clauses += fmt::format("{}'calibrating.dat' index {} using 1:2 with linespoints lt {} title '{}'",
                           index > 0 ? ", " : "", index, index + 1, analysis::gnuplot_text(title));
    ++index;
  }
  f.plot = fmt::format("{}plot {}\n", analysis::figure_style::axes(frames, error), clauses);
  return f;
}

}  // namespace

CostReport cost_of_calibrating(bool quick, const Common& common) {
  ProgressBar bar(common, "calibrating");
  const calibration::CalibrationCost cost = calibration::measure_calibration(
      quick ? std::vector{20, 60} : std::vector{20, 40, 100, 200, 400, 1000}, bar);
  return {as_json(cost), as_text(cost), figure(cost)};
}

}  // namespace twincell::cli
