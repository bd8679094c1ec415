// twincell fit TABLE --law LAW: fits a law to a table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibration/fit/curve_fit.hpp"
#include "calibration/fit/fit_figure.hpp"
#include "calibration/fit/table.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"

namespace twincell::cli {
namespace {

struct FitOptions {
  std::string table, law, output;
  std::string x, y, sigma, trials;
  std::optional<std::array<double, 2>> window;
};

Product fit_folder() {
  return Product::whole_folder("a fit");
}

constexpr std::array<const char*, 4> kUses = {"used", "zero", "outside", "invalid"};

const char* use_name(PointUse use) {
  return kUses[static_cast<std::size_t>(use)];
}

nlohmann::json number(double v) {
  return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
}

std::vector<DataPoint> points_of(const Table& table, FitOptions& o) {
  if (o.x.empty()) o.x = table.names.front();
  if (o.y.empty()) {
    if (table.names.size() < 2)
      throw InputError({.file = table.file, .key = {}}, "a fit needs two columns; the table has one");
    o.y = table.names[1];
  }
  if (o.x == o.y)
    throw ConfigError({.file = {}, .key = "--y"},
                      fmt::format("names the column '{}', which is also that of --x.", o.y));
  const auto &x = table.column(o.x), &y = table.column(o.y);
  std::vector<DataPoint> points(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) points[i] = {x[i], y[i], 0, 0};
  if (!o.sigma.empty() && !o.trials.empty())
    throw ConfigError({.file = {}, .key = "--trials"},
                      "and --sigma both give the error of y; give only one of the two");
  for (const std::string* named : {&o.x, &o.y})
    if (std::none_of(points.begin(), points.end(),
                     [&](const DataPoint& p) { return std::isfinite(named == &o.x ? p.x : p.y); }))
      throw InputError({.file = table.file, .key = *named}, "contains no number");
  if (!o.sigma.empty())
    for (std::size_t i = 0; i < x.size(); ++i) points[i].sigma = table.column(o.sigma)[i];
  if (!o.trials.empty())
    for (std::size_t i = 0; i < x.size(); ++i) points[i].trials = table.column(o.trials)[i];
  return points;
}

/// Checks the columns that cannot be negative: standard deviations and numbers of trials.
void check_errors(const std::vector<DataPoint>& points, const FitOptions& o) {
  const auto refuse = [&](const std::string& column, std::size_t row, double value, const char* bound) {
    throw InputError({.file = o.table, .key = column},
                     fmt::format("row {} contains {:g}; {}", row + 1, value, bound));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].sigma < 0) refuse(o.sigma, i, points[i].sigma, "a standard deviation must not be negative");
    if (points[i].trials < 0 ||
        (std::isfinite(points[i].trials) && points[i].trials != std::floor(points[i].trials)))
      refuse(o.trials, i, points[i].trials, "a number of trials must be a whole number, 0 or more");
  }
}

/// Checks that all frequencies are from 0 to 1. Any other value indicates the wrong column.
void check_frequencies(const std::vector<DataPoint>& points, const FitOptions& o) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].y < 0 || points[i].y > 1)
      throw InputError({.file = o.table, .key = o.y},
                       fmt::format("row {} contains {:g}; with --trials it must be a frequency from 0 to 1",
                                   i + 1, points[i].y));
}

/// The reason why the points are not weighted although errors were given.
std::string why_not_weighted(const CurveFit& fit, const std::vector<DataPoint>& points) {
  std::size_t without = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool binomial = points[i].trials > 0 && points[i].y * (1 - points[i].y) > 0;
    without += fit.use[i] == PointUse::used && !(points[i].sigma > 0) && !binomial ? 1 : 0;
  }
  return fmt::format("not weighted: the given errors are not above 0 at {} of {} points", without,
                     fit.n_used);
}

/// Calls fit_curve() and adds the file name to the message of an InputError.
CurveFit fit_of(const Law& law, const std::vector<DataPoint>& points, const FitOptions& o) {
  FitWindow window;
  if (o.window) window = {(*o.window)[0], (*o.window)[1]};
  try {
    return fit_curve(law, points, window);
  } catch (const InputError& e) {
    throw InputError({.file = o.table, .key = {}}, e.what());
  }
}

std::string text_of(const CurveFit& fit) {
  const FitReport& report = fit.fit;
  std::string text = fmt::format("{}: {}   ({})\n{} points used", fit.law->name, fit.law->formula,
                                 fit.law->source, fit.n_used);
  if (fit.n_outside > 0) text += fmt::format(", {} outside the window", fit.n_outside);
  if (fit.n_zero > 0) text += fmt::format(", {} zero and left out", fit.n_zero);
  if (fit.n_invalid > 0) text += fmt::format(", {} invalid and left out", fit.n_invalid);
  text += fit.weighted ? "; weighted by their errors\n\n" : "; not weighted, errors from the scatter\n\n";
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
    text += fmt::format("residual signs: {} runs, {} points above and {} below, p = {:.3g}\n", fit.runs.runs,
                        fit.runs.positive, fit.runs.negative, fit.runs.p);
  if (!fit.law->nested.empty())
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

nlohmann::json json_of(const CurveFit& fit, const std::vector<DataPoint>& points) {
  const FitReport& report = fit.fit;
  nlohmann::json j;
  j["law"] = {{"name", fit.law->name}, {"formula", fit.law->formula}, {"source", fit.law->source}};
  for (std::size_t p = 0; p < report.values.size(); ++p) {
    nlohmann::json& one = j["parameters"][report.names[p]];
    one["value"] = number(report.values[p]);
    if (!fit.intervals[p]) continue;
    one["standard_error"] = number(report.standard_errors[p]);
    one["interval"] = {{"low", number(fit.intervals[p]->low)},
                       {"high", number(fit.intervals[p]->high)},
                       {"level", fit.intervals[p]->level},
                       {"method", fit.intervals[p]->method}};
  }
  j["covariance"] = nlohmann::json::array();
  for (Eigen::Index r = 0; r < report.covariance.rows(); ++r) {
    j["covariance"].push_back(nlohmann::json::array());
    for (Eigen::Index c = 0; c < report.covariance.cols(); ++c)
      j["covariance"].back().push_back(number(report.covariance(r, c)));
  }
  j["weighted"] = fit.weighted;
  j["n"] = {
      {"used", fit.n_used}, {"zero", fit.n_zero}, {"outside", fit.n_outside}, {"invalid", fit.n_invalid}};
  j["upper_limits"] = fit.upper_limits;
  j["correlation"] = number(fit.correlation);
  j["rms_residual"] = number(report.rms());
  j["runs"] = {{"runs", fit.runs.runs},
               {"positive", fit.runs.positive},
               {"negative", fit.runs.negative},
               {"p", number(fit.runs.p)}};
  if (!fit.law->nested.empty()) j["nested"] = {{"law", fit.law->nested}, {"p", number(fit.p_nested)}};
  j["condition"] = number(report.condition);
  j["undetermined"] = report.undetermined;
  j["stop_reason"] = report.stop_reason;
  j["notes"] = fit.notes;
  j["points"] = nlohmann::json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    nlohmann::json point = {
        {"x", number(points[i].x)}, {"y", number(points[i].y)}, {"use", use_name(fit.use[i])}};
    if (fit.use[i] == PointUse::used) point["fit"] = number(fit.at(points[i].x));
    j["points"].push_back(point);
  }
  return j;
}

void run(const Common& common, FitOptions o) {
  const Law& law = law_named(o.law);
  if (o.window && !((*o.window)[0] < (*o.window)[1]))
    throw ConfigError(
        {.file = {}, .key = "window"},
        fmt::format("[{:g}, {:g}] is not a window: low must be below high", (*o.window)[0], (*o.window)[1]));
  std::optional<AtomicPath> folder;  // opened first: an unwritable folder is reported before the work
  if (!o.output.empty()) folder.emplace(o.output, fit_folder());
  const Table table = read_table(o.table);
  const std::vector<DataPoint> points = points_of(table, o);
  check_errors(points, o);
  if (!o.trials.empty()) check_frequencies(points, o);
  CurveFit fit = fit_of(law, points, o);
  if (!fit.weighted && !(o.sigma.empty() && o.trials.empty()))
    fit.notes.push_back(why_not_weighted(fit, points));

  Provenance provenance = common.provenance();
  provenance.inputs = {o.table};
  nlohmann::json document = json_of(fit, points);
  document["provenance"] = nlohmann::json::parse(provenance.to_json());
  std::string text = text_of(fit);
  if (folder) {
    draw(fit_figure(fit, points, o.x, o.y), folder->part());
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
  for (const Law* law : laws()) names += (names.empty() ? "" : ", ") + law->name;
  verb.add_option("table", o->table, "Table to fit (CSV with a header line)")->required();
  verb.add_option("--law", o->law, names)->required()->type_name(kWord);
  verb.add_option("--x", o->x, "Column of the abscissa; default: the first")->type_name(kWord);
  verb.add_option("--y", o->y, "Column of the ordinate; default: the second")->type_name(kWord);
  verb.add_option("--sigma", o->sigma,
                  "Column of the standard deviation of y; default: none, all points count equally")
      ->type_name(kWord);
  verb.add_option("--trials", o->trials,
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
