// twincell fit TABLE --law LAW: fits a law to a table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibration/fit/fit_figure.hpp"
#include "calibration/fit/table_fit.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"

namespace twincell::cli {
namespace {

struct FitOptions {
  std::string table, law, output;
  calibration::FitColumns columns;
  std::optional<std::array<double, 2>> window;
};

Product fit_folder() {
  std::vector<std::string> files = analysis::figure_files("fit");
  files.emplace_back("fit.json");
  return Product::whole_folder("a fit", std::move(files));
}

std::string text_of(const calibration::TableFit& result) {
  const calibration::CurveFit& fit = result.fit;
  const calibration::FitReport& report = fit.fit;
  std::string text = fmt::format("{}: {}   ({})\nx is {}, y is {}; {} used", fit.law->name, fit.law->formula,
                                 fit.law->source, one_line(result.columns.x), one_line(result.columns.y),
                                 plural(fit.n_used, "point"));
  if (fit.n_outside > 0) text += fmt::format(", {} outside the window", fit.n_outside);
  if (fit.n_zero > 0)
    text += fit.likelihood ? fmt::format(", {} of them zero", fit.n_zero)
                           : fmt::format(", {} zero and left out", fit.n_zero);
  if (fit.n_invalid > 0) text += fmt::format(", {} invalid and left out", fit.n_invalid);
  text += fit.likelihood ? "; maximum likelihood of the counts\n\n"
          : fit.weighted ? "; weighted by their errors\n\n"
                         : "; not weighted, errors from the scatter\n\n";
  text += fmt::format("{:<10}  {:<14}  {:<12}  95 % interval\n", "parameter", "value", "error");
  for (std::size_t p = 0; p < report.values.size(); ++p) {
    text += fmt::format("{:<10}  {:<14.8g}  ", report.names[p], report.values[p]);
    text += fit.intervals[p] ? fmt::format("{:<12.3g}  [{:.6g}, {:.6g}]\n", report.standard_errors[p],
                                           fit.intervals[p]->low, fit.intervals[p]->high)
                             : "-             -\n";
  }
  text += "\n";
  if (std::isfinite(fit.correlation))
    text += fmt::format("correlation with the curve: {:.6f}\n", fit.correlation);
  text += fmt::format("rms residual: {:.4g}\n", report.rms());
  if (std::isfinite(fit.runs.p))
    text +=
        fmt::format("residual signs: {}, {} above and {} below, p = {:.3g}\n", plural(fit.runs.runs, "run"),
                    plural(fit.runs.positive, "point"), fit.runs.negative, fit.runs.p);
  if (!fit.law->nested.empty() && std::isfinite(fit.p_nested))
    text += fmt::format("against {}: p = {:.3g}\n", fit.law->nested, fit.p_nested);
  text += fmt::format("condition number: {:.3g}\n", report.condition);
  text += report.undetermined.empty()
              ? "undetermined: none\n"
              : fmt::format("undetermined: {}\n", fmt::join(report.undetermined, ", "));
  if (!fit.upper_limits.empty()) {
    text += "upper limits of the zero points (95 %):";
    for (const double limit : fit.upper_limits) text += fmt::format(" {:.3g}", limit);
    text += "\n";
  }
  text += "stopped: " + report.stop_reason + "\n";
  for (const std::string& note : fit.notes) text += "note: " + note + "\n";
  return text;
}

void run(const Common& common, FitOptions o) {
  calibration::check_fit(o.law, o.window);
  std::optional<AtomicPath> folder;  // opened first: an unwritable folder is reported before the work
  if (!o.output.empty()) folder.emplace(o.output, fit_folder());
  const calibration::TableFit result =
      calibration::fit_table(read_table(o.table), o.law, o.columns, o.window);
  const calibration::CurveFit& fit = result.fit;

  Provenance provenance = common.provenance();
  provenance.inputs = {o.table};
  nlohmann::json document = nlohmann::json::parse(calibration::fit_json(result));
  document["provenance"] = nlohmann::json::parse(provenance.to_json());
  std::string text = text_of(result);
  if (folder) {
    analysis::draw(calibration::fit_figure(fit, result.points, result.columns.x, result.columns.y),
                   folder->part());
    write_text_file(folder->part() / "fit.json", json_text(document, 2) + "\n");
    folder->commit();
    text += fmt::format("picture: {}\n", (folder->final() / "fit.svg").string());
  }
  print_result(common, document, text);
}

}  // namespace

void add_fit(CLI::App& program, Common& common) {
  CLI::App& verb = add_verb(program, common, "fit",
                            "Fit a law to a table. Prints the parameters with errors and the diagnostics of "
                            "the residuals; -o also writes the figure, its data and fit.json.",
                            "twincell fit p_s.csv --law arrhenius --x K_m --y p_s --trials trials -o fit/");
  auto o = std::make_shared<FitOptions>();
  std::string names;
  for (const calibration::Law* law : calibration::laws()) names += (names.empty() ? "" : ", ") + law->name;
  verb.add_option("table", o->table, "Table to fit (CSV with a header line)")->required();
  verb.add_option("--law", o->law, "Law to fit, docs/fitting.md: " + names)->required()->type_name(kWord);
  verb.add_option("--x", o->columns.x, "Column of the abscissa; default: the first")->type_name(kWord);
  verb.add_option("--y", o->columns.y, "Column of the ordinate; default: the second")->type_name(kWord);
  verb.add_option("--sigma", o->columns.sigma,
                  "Column of the standard deviation of y; default: none, all points count equally")
      ->type_name(kWord);
  verb.add_option("--trials", o->columns.trials,
                  "Column of the number of trials, if y is a frequency; not together with --sigma")
      ->type_name(kWord);
  verb.add_option("--window", o->window, "Use only points with LOW <= x <= HIGH; default: all")
      ->delimiter(',')
      ->type_name("LOW,HIGH");
  writes(common, verb,
         verb.add_option("-o,--output", o->output, "Folder for the figure, its data and fit.json"),
         fit_folder());
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
