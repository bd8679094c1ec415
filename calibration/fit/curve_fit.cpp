#include "calibration/fit/curve_fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "calibration/fit/chi_square.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {
namespace {

constexpr double kSignificance = 0.05;    // probability below which a deviation is not chance
constexpr double kMaxCorrelation = 0.99;  // of two parameters
/// A residual sum of squares below this share of the ordinates' sum of squares is rounding error.
constexpr double kExactFitShare = 1e-26;

/// A frequency of counts, zeros included.
struct Frequency {
  double x, y, trials;
};

struct Selected {
  std::vector<FitPoint> points;
  bool weighted = false;
  std::vector<Frequency> frequencies;  ///< all points in the window, if each has trials and no other error
};

double error_of(const DataPoint& p, bool logarithmic) {
  const double sigma = p.sigma > 0    ? p.sigma
                       : p.trials > 0 ? std::sqrt(std::max(0.0, p.y * (1 - p.y)) / p.trials)
                                      : 0;
  return logarithmic ? sigma / p.y : sigma;
}

/// Classifies the points, records the counts in `result`, and returns those that enter the fit.
Selected select(const Law& law, const std::vector<DataPoint>& points, const FitWindow& window,
                CurveFit& result) {
  Selected selected;
  double low = INFINITY, high = -INFINITY, largest_x = 0, largest_y = 0;
  bool errors = true, counts = law.logarithmic;
  for (const DataPoint& p : points) {
    PointUse use = PointUse::used;
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !(p.sigma >= 0) || (law.positive_x && p.x <= 0) ||
        (law.logarithmic && p.y < 0)) {
      use = PointUse::invalid;
    } else {
      low = std::min(low, p.x);
      high = std::max(high, p.x);
      if (p.x < window.low || p.x > window.high)
        use = PointUse::outside;
      else if (law.logarithmic && p.y == 0)
        use = PointUse::zero;
    }
    result.use.push_back(use);
    result.n_used += use == PointUse::used ? 1 : 0;
    result.n_zero += use == PointUse::zero ? 1 : 0;
    result.n_outside += use == PointUse::outside ? 1 : 0;
    result.n_invalid += use == PointUse::invalid ? 1 : 0;
    if (use == PointUse::zero || use == PointUse::used) {
      counts = counts && p.trials > 0 && p.sigma == 0 && p.y <= 1;
      selected.frequencies.push_back({p.x, p.y, p.trials});
    }
    if (use == PointUse::zero && p.trials > 0)
      result.upper_limits.push_back(analysis::binomial_interval(0, p.trials, "trials").high);
    if (use != PointUse::used) continue;
    const double error = error_of(p, law.logarithmic);
    errors = errors && error > 0;
    constexpr double kMaxCoordinate = 1e150;
    if (std::abs(p.x) > kMaxCoordinate || std::abs(p.y) > kMaxCoordinate)
      throw InputError({.file = {}, .key = "points"},
                       fmt::format("a point is at ({:g}, {:g}); both must be within +-{:g}, or their squares "
                                   "overflow",
                                   p.x, p.y, kMaxCoordinate));
    selected.points.push_back({p.x, law.logarithmic ? std::log(p.y) : p.y, error});
    largest_x = std::max(largest_x, std::abs(p.x));
    largest_y = std::max(largest_y, std::abs(selected.points.back().y));
  }
  // All of them so small that their squares are 0 would give errors of 0.
  constexpr double kMinCoordinate = 1e-150;
  if (const double largest = std::min(largest_x > 0 ? largest_x : 1, largest_y > 0 ? largest_y : 1);
      largest < kMinCoordinate)
    throw InputError(
        {.file = {}, .key = "points"},
        fmt::format("no {} is larger than {:g} in magnitude; use another unit, or the squares are 0",
                    largest == largest_x ? "x" : "y", largest));
  if (!counts) selected.frequencies.clear();
  selected.weighted = errors;
  if (!errors)
    for (FitPoint& p : selected.points) p.error = 1;

  const std::string data =
      low > high ? "there is no valid point among the data"
                 : fmt::format("the data span [{:g}, {:g}], {} of them zero", low, high, result.n_zero);
  const FitWindow everything;
  if (selected.points.empty() && window.low == everything.low && window.high == everything.high)
    throw InputError({.file = {}, .key = "points"},
                     fmt::format("none of the {} points can be fitted: {} zero, {} invalid for {}",
                                 points.size(), result.n_zero, result.n_invalid, law.name));
  if (selected.points.empty())
    throw InputError({.file = {}, .key = "window"},
                     fmt::format("no point to fit is in [{:g}, {:g}]; {}", window.low, window.high, data));
  std::set<double> abscissas;
  for (const FitPoint& p : selected.points) abscissas.insert(p.x);
  const std::size_t needed = law.parameters.size();
  if (abscissas.size() < std::min<std::size_t>(2, needed) || selected.points.size() < needed)
    throw InputError(
        {.file = {}, .key = "points"},
        fmt::format("{} at {} cannot determine the {} of {}; {}", plural(selected.points.size(), "point"),
                    abscissas.size() == 1 ? "one abscissa" : plural(abscissas.size(), "abscissa"),
                    plural(needed, "parameter"), law.name, data));
  return selected;
}

/// Fit from one start. \returns the report; cost_after ranks the results of several starts
FitReport from_start(const Law& law, const Selected& selected, std::vector<double> parameters) {
  ceres::Problem problem;
  for (const FitPoint& point : selected.points)
    problem.AddResidualBlock(law.residual(point), nullptr, parameters.data());
  return solve(problem, parameters.data(), law.parameters,
               selected.weighted ? Residuals::weighted : Residuals::unweighted);
}

FitReport best_of_starts(const Law& law, const Selected& selected) {
  std::optional<FitReport> best;
  std::string failure = "the law has no start for these points";
  for (const std::vector<double>& start : law.starts(selected.points)) {
    FitReport report = from_start(law, selected, start);
    const bool finite =
        std::all_of(report.values.begin(), report.values.end(), [](double v) { return std::isfinite(v); });
    if (!report.usable || !finite)
      failure = report.stop_reason;
    else if (!best || report.cost_after < best->cost_after)
      best = std::move(report);
  }
  if (!best) throw RunError(fmt::format("The fit of {} did not converge: {}", law.name, failure));
  return *best;
}

/// ln p of a frequency by the law. A probability of 1 is approached, not reached.
double log_probability(const Law& law, const Frequency& f, const std::vector<double>& parameters) {
  constexpr double kMaxLog = -1e-9;
  return std::min(law.value(f.x, parameters.data()), kMaxLog);
}

/// Logarithm of the binomial likelihood, up to a constant.
double log_likelihood(const Law& law, const std::vector<Frequency>& frequencies,
                      const std::vector<double>& parameters) {
  double sum = 0;
  for (const Frequency& f : frequencies) {
    const double log_p = log_probability(law, f, parameters);
    sum += f.trials * (f.y * log_p + (1 - f.y) * std::log(-std::expm1(log_p)));
  }
  return sum;
}

/// Maximum likelihood of the frequencies from the parameters of `report`, which it replaces; so are the
/// points, by working ordinates ln p + (y - p)/p with the errors sqrt((1 - p)/(n p)). A step that lowers the
/// likelihood is halved. (Ordinates that were limited to 10 from the curve kept the fit away from the
/// maximum.) \returns whether it converged
bool maximise_likelihood(const Law& law, Selected& selected, FitReport& report) {
  constexpr int kRounds = 100, kHalvings = 40;
  constexpr double kConverged = 1e-9;
  Selected working{.points = {}, .weighted = true, .frequencies = {}};
  FitReport now = report;
  double likelihood = log_likelihood(law, selected.frequencies, now.values);
  for (int round = 0; round < kRounds; ++round) {
    working.points.clear();
    for (const Frequency& f : selected.frequencies) {
      const double log_p = log_probability(law, f, now.values), p = std::exp(log_p);
      if (!(p > 0)) return false;
      working.points.push_back({f.x, log_p + (f.y - p) / p, std::sqrt((1 - p) / (f.trials * p))});
    }
    FitReport next = from_start(law, working, now.values);
    for (const double value : next.values)
      if (!next.usable || !std::isfinite(value)) return false;
    double reached = log_likelihood(law, selected.frequencies, next.values);
    for (int k = 0; k < kHalvings && !(reached >= likelihood); ++k) {
      for (std::size_t q = 0; q < next.values.size(); ++q)
        next.values[q] = 0.5 * (next.values[q] + now.values[q]);
      reached = log_likelihood(law, selected.frequencies, next.values);
    }
    double change = 0;
    for (std::size_t k = 0; k < next.values.size(); ++k)
      change = std::max(change, std::abs(next.values[k] - now.values[k]) / (1 + std::abs(next.values[k])));
    now = std::move(next);
    likelihood = reached;
    if (change > kConverged) continue;
    report = std::move(now);
    selected.points = std::move(working.points);
    selected.weighted = true;
    return true;
  }
  return false;
}

/// The highest maximum that is reached from `report` and from the starts of the law: the likelihood of a bent
/// line has one between any two points, and a kink at every point. \returns whether one was reached
bool best_likelihood(const Law& law, Selected& selected, FitReport& report) {
  constexpr std::size_t kMaxStarts = 8;
  std::vector<std::vector<double>> starts = law.starts(selected.points);
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const double likelihood = log_likelihood(law, selected.frequencies, starts[k]);
    if (std::isfinite(likelihood)) ranked.emplace_back(-likelihood, k);
  }
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(ranked.size(), kMaxStarts));
  std::vector<std::vector<double>> tried = {report.values};
  for (const auto& [rank, k] : ranked) tried.push_back(starts[k]);
  std::optional<std::pair<FitReport, Selected>> best;
  double most = -INFINITY;
  for (const std::vector<double>& start : tried) {
    FitReport fit = report;
    fit.values = start;
    Selected points = selected;
    if (!std::isfinite(log_likelihood(law, selected.frequencies, start)) ||
        !maximise_likelihood(law, points, fit))
      continue;
    const double reached = log_likelihood(law, selected.frequencies, fit.values);
    if (!(reached > most)) continue;
    most = reached;
    best.emplace(std::move(fit), std::move(points));
  }
  if (!best) return false;
  report = std::move(best->first);
  selected = std::move(best->second);
  return true;
}

double correlation_of(const std::vector<FitPoint>& points, const std::vector<double>& curve) {
  const auto n = static_cast<double>(points.size());
  double y = 0, f = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    y += points[i].y / n;
    f += curve[i] / n;
  }
  double yy = 0, ff = 0, yf = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    yy += (points[i].y - y) * (points[i].y - y);
    ff += (curve[i] - f) * (curve[i] - f);
    yf += (points[i].y - y) * (curve[i] - f);
  }
  return yy > 0 && ff > 0 ? yf / std::sqrt(yy * ff) : kNaN;
}

/// Correlation of the frequencies, zeros included, with the probabilities of the law.
double correlation_of_frequencies(const CurveFit& fit, const Selected& selected) {
  std::vector<FitPoint> points;
  std::vector<double> curve;
  for (const Frequency& f : selected.frequencies) {
    points.push_back({f.x, f.y, 1});
    curve.push_back(fit.at(f.x));
  }
  return correlation_of(points, curve);
}

/// Half the sum of squares of the ordinates, in units of their errors.
double squares_of(const Selected& selected) {
  double total = 0;
  for (const FitPoint& p : selected.points) total += p.y * p.y / (p.error * p.error) / 2;
  return total;
}

/// Probability that `extra` parameters without effect reduce the sum of squares by this much (F test, chi^2
/// if weighted).
double chance_of_gain(double nested_squares, double squares, std::size_t points, std::size_t parameters,
                      std::size_t extra, bool weighted) {
  const double gain = std::max(0.0, nested_squares - squares);
  const auto k = static_cast<double>(extra);
  if (weighted) return boost::math::cdf(boost::math::complement(boost::math::chi_squared(k), gain));
  if (points <= parameters) return kNaN;
  const auto freedom = static_cast<double>(points - parameters);
  if (squares <= 1e-28 * nested_squares) return nested_squares > 0 ? 0 : 1;
  return boost::math::cdf(
      boost::math::complement(boost::math::fisher_f(k, freedom), gain / k / (squares / freedom)));
}

void compare_with_nested(CurveFit& result, const Selected& selected) {
  const Law& law = *result.law;
  result.p_nested = kNaN;
  if (law.nested.empty()) return;
  const Law& simple = law_named(law.nested);
  const FitReport nested = best_of_starts(simple, selected);
  const std::size_t n = selected.points.size(), parameters = law.parameters.size();
  const bool exact = nested.cost_after <= kExactFitShare * squares_of(selected);
  result.p_nested = exact ? 1
                          : chance_of_gain(2 * nested.cost_after, 2 * result.fit.cost_after, n, parameters,
                                           parameters - simple.parameters.size(), result.weighted);
  if (!(result.p_nested > kSignificance)) return;
  for (const std::string& name : law.lost)
    if (std::find(result.fit.undetermined.begin(), result.fit.undetermined.end(), name) ==
        result.fit.undetermined.end())
      result.fit.undetermined.push_back(name);
  result.notes.push_back(fmt::format("{} describes the points as well (p = {:.2g}): {} undetermined",
                                     simple.name, result.p_nested, fmt::join(law.lost, " and ")));
}

/// 95 % interval of the bend by profile of the sum of squares: all bends whose sum of squares exceeds the
/// least one by less than the threshold for one parameter. The covariance would be too small, because the
/// derivative at a kink jumps at every point.
analysis::Interval interval_of_bend(const CurveFit& result, const Selected& selected, double reach) {
  const Law& law = *result.law;
  const double freedom = static_cast<double>(result.n_used - result.fit.values.size());
  const double least = 2 * result.fit.cost_after, best = result.fit.values.back();
  const double most = least + reach * reach * (result.weighted ? 1 : least / freedom);
  const auto inside = [&](double bend) { return law.squares_bent_at(selected.points, bend) <= most; };
  // A bend needs two points on either side.
  const double low = selected.points[1].x, high = selected.points[selected.points.size() - 2].x;
  const auto edge = [&](double end) {
    constexpr int kSteps = 400;
    double in = best, out = end;
    for (int i = 0; i <= kSteps; ++i) {  // from the end inwards to the outermost bend that is not excluded
      const double x = end * std::pow(best / end, static_cast<double>(i) / kSteps);
      if (!inside(x)) {
        out = x;
        continue;
      }
      in = x;
      break;
    }
    if (in == end) return end;
    for (int i = 0; i < 40; ++i) {
      const double middle = (in + out) / 2;
      (inside(middle) ? in : out) = middle;
    }
    return in;
  };
  return {std::min(best, edge(low)), std::max(best, edge(high)), 0.95, "profile of the squares"};
}

void add_intervals(CurveFit& result, const Selected& selected) {
  const FitReport& fit = result.fit;
  result.intervals.assign(fit.values.size(), std::nullopt);
  if (fit.standard_errors.empty()) return;
  const double freedom = static_cast<double>(result.n_used - fit.values.size());
  const double reach = result.weighted ? analysis::student_t_95(1e9) : analysis::student_t_95(freedom);
  const std::string method = result.likelihood ? "covariance at the maximum of the likelihood"
                             : result.weighted
                                 ? "covariance of the points' own errors"
                                 : fmt::format("covariance and scatter, {} degrees of freedom", freedom);
  for (std::size_t p = 0; p < fit.values.size(); ++p)
    result.intervals[p] = analysis::Interval{fit.values[p] - reach * fit.standard_errors[p],
                                             fit.values[p] + reach * fit.standard_errors[p], 0.95, method};
  if (result.law->squares_bent_at && fit.values.back() > 0)
    result.intervals.back() = interval_of_bend(result, selected, reach);
  // Data without scatter would give undetermined parameters an error of 0, so they get no interval.
  if (!result.weighted && result.fit.cost_after <= kExactFitShare * squares_of(selected))
    for (std::size_t p = 0; p < fit.values.size(); ++p)
      if (std::find(fit.undetermined.begin(), fit.undetermined.end(), fit.names[p]) != fit.undetermined.end())
        result.intervals[p].reset();
}

void add_notes(CurveFit& result, const Selected& selected) {
  const FitReport& fit = result.fit;
  if (std::all_of(selected.points.begin(), selected.points.end(),
                  [&](const FitPoint& p) { return p.y == selected.points.front().y; }))
    result.notes.emplace_back("constant ordinate");
  if (!fit.why_not.empty()) result.notes.push_back(fit.why_not);
  for (Eigen::Index a = 0; a < fit.covariance.rows(); ++a)
    for (Eigen::Index b = a + 1; b < fit.covariance.cols(); ++b) {
      const double r = fit.covariance(a, b) / std::sqrt(fit.covariance(a, a) * fit.covariance(b, b));
      if (std::abs(r) > kMaxCorrelation)
        result.notes.push_back(
            fmt::format("{} and {} are correlated ({:.4f}): compare curves, not coefficients",
                        fit.names[static_cast<std::size_t>(a)], fit.names[static_cast<std::size_t>(b)], r));
    }
  const double chi2 = 2 * fit.cost_after,
               freedom = static_cast<double>(selected.points.size()) - static_cast<double>(fit.values.size());
  if (result.weighted && is_beyond_errors(chi2, freedom))
    result.notes.push_back(
        fmt::format("the curve misses the points by more than their stated errors: chi^2 = {:.3g} of {:g}; "
                    "the intervals hold only for a law that describes the points",
                    chi2, freedom));
  if (result.runs.p < kSignificance)
    result.notes.push_back(fmt::format(
        "residuals are not in random order: {} runs of {} above and {} below the curve (p = {:.2g})",
        result.runs.runs, result.runs.positive, result.runs.negative, result.runs.p));
}

}  // namespace

RunsTest runs_test(const std::vector<double>& residuals) {
  RunsTest test;
  int last = 0;
  for (const double r : residuals) {
    const int sign = r > 0 ? 1 : r < 0 ? -1 : 0;
    if (sign == 0) continue;
    (sign > 0 ? test.positive : test.negative) += 1;
    test.runs += sign != last ? 1 : 0;
    last = sign;
  }
  const auto n1 = static_cast<double>(test.positive), n2 = static_cast<double>(test.negative);
  if (n1 == 0 || n2 == 0) {
    test.p = kNaN;
    return test;
  }
  const auto log_choose = [](double n, double k) {
    return k < 0 || k > n ? -std::numeric_limits<double>::infinity()
                          : std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
  };
  const double all = log_choose(n1 + n2, n1);
  double at_most = 0, at_least = 0;
  for (std::size_t r = 2; r <= test.positive + test.negative; ++r) {
    const double k = std::floor(static_cast<double>(r) / 2);
    const double share = r % 2 == 0
                             ? 2 * std::exp(log_choose(n1 - 1, k - 1) + log_choose(n2 - 1, k - 1) - all)
                             : std::exp(log_choose(n1 - 1, k) + log_choose(n2 - 1, k - 1) - all) +
                                   std::exp(log_choose(n1 - 1, k - 1) + log_choose(n2 - 1, k) - all);
    if (r <= test.runs) at_most += share;
    if (r >= test.runs) at_least += share;
  }
  test.p = std::min(1.0, 2 * std::min(at_most, at_least));
  return test;
}

double CurveFit::at(double x) const {
  const double y = law->value(x, fit.values.data());
  return law->logarithmic ? std::exp(y) : y;
}

double CurveFit::error_at(double x) const {
  if (fit.covariance.size() == 0) return kNaN;
  Eigen::VectorXd gradient(static_cast<Eigen::Index>(fit.values.size()));
  std::vector<double> moved = fit.values;
  for (std::size_t p = 0; p < moved.size(); ++p) {
    const double step = 1e-5 * std::max(std::abs(fit.values[p]), 1e-3 * fit.standard_errors[p]) + 1e-300;
    moved[p] = fit.values[p] + step;
    const double above = law->value(x, moved.data());
    moved[p] = fit.values[p] - step;
    gradient[static_cast<Eigen::Index>(p)] = (above - law->value(x, moved.data())) / (2 * step);
    moved[p] = fit.values[p];
  }
  return std::sqrt(std::max(0.0, gradient.dot(fit.covariance * gradient)));
}

CurveFit fit_curve(const Law& law, const std::vector<DataPoint>& points, const FitWindow& window) {
  CurveFit result;
  result.law = &law;
  Selected selected = select(law, points, window, result);
  result.weighted = selected.weighted;
  result.fit = best_of_starts(law, selected);
  if (!selected.frequencies.empty()) {
    result.likelihood = best_likelihood(law, selected, result.fit);
    if (result.likelihood)
      result.weighted = true, result.n_used += result.n_zero;
    else if (result.n_zero > 0)
      result.notes.emplace_back(
          "the likelihood of the counts has no maximum near this fit, which leaves zeros out");
  }

  std::sort(selected.points.begin(), selected.points.end(),
            [](const FitPoint& p, const FitPoint& q) { return p.x < q.x; });
  std::vector<double> curve, residuals;
  for (const FitPoint& p : selected.points) {
    curve.push_back(law.value(p.x, result.fit.values.data()));
    residuals.push_back((p.y - curve.back()) / p.error);
  }
  result.correlation = result.likelihood ? correlation_of_frequencies(result, selected)
                                         : correlation_of(selected.points, curve);
  result.runs = runs_test(residuals);
  compare_with_nested(result, selected);
  add_intervals(result, selected);
  add_notes(result, selected);
  return result;
}

}  // namespace twincell::calibration
