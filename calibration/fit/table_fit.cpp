#include "calibration/fit/table_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {

namespace {

constexpr std::array<const char*, 4> kUses = {"used", "zero", "outside", "invalid"};

const char* use_name(PointUse use) {
  return kUses[static_cast<std::size_t>(use)];
}

std::vector<DataPoint> points_of(const Table& table, FitColumns& o) {
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
void check_errors(const std::string& file, const std::vector<DataPoint>& points, const FitColumns& o) {
  const auto refuse = [&](const std::string& column, std::size_t row, double value, const char* bound) {
    throw InputError({.file = file, .key = column},
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
void check_frequencies(const std::string& file, const std::vector<DataPoint>& points, const FitColumns& o) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].y < 0 || points[i].y > 1)
      throw InputError({.file = file, .key = o.y},
                       fmt::format("row {} contains {:g}; with --trials it must be a frequency from 0 to 1",
                                   i + 1, points[i].y));
}

/// Leaves out the frequencies of 0 trials, which carry no information. \returns the number of such rows
std::size_t leave_out_untried(std::vector<DataPoint>& points) {
  std::size_t untried = 0;
  for (DataPoint& p : points)
    if (!(p.trials > 0)) p.y = kNaN, ++untried;
  return untried;
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
CurveFit fit_of(const Law& law, const std::string& file, const std::vector<DataPoint>& points,
                const std::optional<std::array<double, 2>>& said) {
  FitWindow window;
  if (said) window = {(*said)[0], (*said)[1]};
  try {
    return fit_curve(law, points, window);
  } catch (const InputError& e) {
    throw InputError({.file = file, .key = {}}, e.what());
  }
}

nlohmann::json json_of(const CurveFit& fit, const std::vector<DataPoint>& points) {
  const FitReport& report = fit.fit;
  nlohmann::json j;
  j["law"] = {{"name", fit.law->name}, {"formula", fit.law->formula}, {"source", fit.law->source}};
  for (std::size_t p = 0; p < report.values.size(); ++p) {
    nlohmann::json& one = j["parameters"][report.names[p]];
    one["value"] = number_or_null(report.values[p]);
    if (!fit.intervals[p]) continue;
    one["standard_error"] = number_or_null(report.standard_errors[p]);
    one["interval"] = {{"low", number_or_null(fit.intervals[p]->low)},
                       {"high", number_or_null(fit.intervals[p]->high)},
                       {"level", fit.intervals[p]->level},
                       {"method", fit.intervals[p]->method}};
  }
  j["covariance_of"] = report.names;  // JSON sorts the keys of "parameters"
  j["covariance"] = nlohmann::json::array();
  for (Eigen::Index r = 0; r < report.covariance.rows(); ++r) {
    j["covariance"].push_back(nlohmann::json::array());
    for (Eigen::Index c = 0; c < report.covariance.cols(); ++c)
      j["covariance"].back().push_back(number_or_null(report.covariance(r, c)));
  }
  j["weighted"] = fit.weighted;
  j["likelihood"] = fit.likelihood;
  j["n"] = {
      {"used", fit.n_used}, {"zero", fit.n_zero}, {"outside", fit.n_outside}, {"invalid", fit.n_invalid}};
  j["upper_limits"] = fit.upper_limits;
  j["correlation"] = number_or_null(fit.correlation);
  j["rms_residual"] = number_or_null(report.rms());
  j["runs"] = {{"runs", fit.runs.runs},
               {"positive", fit.runs.positive},
               {"negative", fit.runs.negative},
               {"p", number_or_null(fit.runs.p)}};
  if (!fit.law->nested.empty()) j["nested"] = {{"law", fit.law->nested}, {"p", number_or_null(fit.p_nested)}};
  j["condition"] = number_or_null(report.condition);
  j["undetermined"] = report.undetermined;
  j["stop_reason"] = report.stop_reason;
  j["notes"] = fit.notes;
  j["points"] = nlohmann::json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    nlohmann::json point = {{"x", number_or_null(points[i].x)},
                            {"y", number_or_null(points[i].y)},
                            {"use", use_name(fit.use[i])}};
    if (fit.use[i] == PointUse::used || (fit.likelihood && fit.use[i] == PointUse::zero))
      point["fit"] = number_or_null(fit.at(points[i].x));
    j["points"].push_back(point);
  }
  return j;
}

/// Number of points that are equal to an earlier one.
std::size_t repeated(const std::vector<DataPoint>& points) {
  std::set<std::array<double, 4>> seen;
  for (const DataPoint& p : points) seen.insert({p.x, p.y, p.sigma, p.trials});
  return points.size() - seen.size();
}

}  // namespace

void check_fit(const std::string& law, const std::optional<std::array<double, 2>>& window) {
  (void)law_named(law);
  if (window && !((*window)[0] < (*window)[1]))
    throw ConfigError(
        {.file = {}, .key = "--window"},
        fmt::format("[{:g}, {:g}] is not a window: low must be below high", (*window)[0], (*window)[1]));
}

TableFit fit_table(const Table& table, const std::string& law, FitColumns columns,
                   const std::optional<std::array<double, 2>>& window) {
  check_fit(law, window);
  std::vector<DataPoint> points = points_of(table, columns);
  check_errors(table.file, points, columns);
  if (!columns.trials.empty()) check_frequencies(table.file, points, columns);
  const std::size_t untried = columns.trials.empty() ? 0 : leave_out_untried(points);
  CurveFit fit = fit_of(law_named(law), table.file, points, window);
  if (untried > 0) fit.notes.push_back(fmt::format("{} without trials left out", plural(untried, "row")));
  if (!fit.weighted && !(columns.sigma.empty() && columns.trials.empty()))
    fit.notes.push_back(why_not_weighted(fit, points));
  if (const std::size_t again = repeated(points); again > 0)
    fit.notes.push_back(
        fmt::format("{} equal to another one to the last digit; each counts as a measurement of "
                    "its own, and the errors are too small if they are copies",
                    again == 1 ? "1 point is" : fmt::format("{} points are", again)));
  return {std::move(fit), std::move(points), std::move(columns)};
}

std::string fit_json(const TableFit& fit) {
  return json_text(json_of(fit.fit, fit.points));
}

}  // namespace twincell::calibration
