#include "calibration/contact/inference.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>

#include "analysis/statistics/statistics.hpp"
#include "calibration/fit/chi_square.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"

namespace twincell::calibration {
namespace {

constexpr int kSteps = 60;  // sets the grid steps of a profile

/// All monomials 1, x_i, x_i x_k, ... up to `degree`, where each x_i is scaled to -1 ... 1 over its range.
Eigen::VectorXd terms(const std::vector<Sought>& ranges, const std::vector<double>& theta, int degree) {
  std::vector<double> out = {1};
  std::vector<std::size_t> newest(1, 0);  // largest i of each term, so that no term appears twice
  for (std::size_t begin = 0, d = 0; d < static_cast<std::size_t>(degree); ++d) {
    const std::size_t end = out.size();
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t i = newest[k]; i < ranges.size(); ++i) {
        const Sought& r = ranges[i];
        out.push_back(out[k] * (2 * (theta[i] - r.lower) / (r.upper - r.lower) - 1));
        newest.push_back(i);
      }
    begin = end;
  }
  return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/// A polynomial surface fitted to values.
struct Polynomial {
  int degree = 0;
  Eigen::VectorXd c;
  Eigen::MatrixXd spread;  ///< covariance of c over the scatter squared
  Eigen::VectorXd left;    ///< residuals
  double left_out = 0;     ///< rms leave-one-out prediction error
};

/// The surface of degree 2 or 3 with the smaller leave-one-out error. Observables that are nearly constant
/// over most of a range and change strongly at its end (beds of nearly elastic beads) need degree 3.
Polynomial best_surface(const std::vector<Sought>& ranges, const std::vector<std::vector<double>>& places,
                        const Eigen::VectorXd& y) {
  constexpr double kMaxErrorRatio = 0.95;  // of degree 3 to degree 2; a smaller improvement may be chance
  Polynomial best;
  for (const int degree : {2, 3}) {
    Polynomial p{.degree = degree, .c = {}, .spread = {}, .left = {}};
    const Eigen::Index n = terms(ranges, places.front(), degree).size();
    if (y.size() < n + 2) break;
    Eigen::MatrixXd basis(y.size(), n);
    for (Eigen::Index i = 0; i < y.size(); ++i)
      basis.row(i) = terms(ranges, places[static_cast<std::size_t>(i)], degree).transpose();
    p.c = basis.colPivHouseholderQr().solve(y);
    p.left = y - basis * p.c;
    p.spread = (basis.transpose() * basis).inverse();
    const Eigen::ArrayXd leverage = (basis * p.spread).cwiseProduct(basis).rowwise().sum().array();
    p.left_out = std::sqrt((p.left.array() / (1 - leverage).max(1e-6)).square().mean());
    if (degree == 2 || p.left_out < kMaxErrorRatio * best.left_out) best = p;
  }
  return best;
}

/// One observable as a function of the parameters; its condition, if any, is the last variable.
class Surface {
 public:
  /// Number of runs that a quadratic surface over `ranges` variables needs, plus two for the scatter.
  static std::size_t fewest(std::size_t ranges) { return (ranges + 1) * (ranges + 2) / 2 + 2; }

  Surface(std::vector<Sought> sought, const std::vector<SimulatedPoint>& runs, std::size_t o,
          const MeasuredObservable& measured)
      : ranges_(std::move(sought)), condition_(measured.at), residual_(runs.size(), kNaN) {
    if (condition_) ranges_.push_back(condition_->tried);
    std::vector<std::size_t> used;
    std::vector<std::vector<double>> places;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (!std::isfinite(runs[i].y[o])) continue;
      used.push_back(i);
      places.push_back(runs[i].theta);
      if (condition_) places.back().push_back(runs[i].at[o]);
    }
    const std::size_t least = fewest(ranges_.size());
    if (used.size() < least)
      throw InputError({.file = {}, .key = "runs"},
                       fmt::format("{} of {} runs have a value of {}; its quadratic surface needs {}.",
                                   used.size(), runs.size(), measured.name, least));
    Eigen::VectorXd y(static_cast<Eigen::Index>(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i) y[static_cast<Eigen::Index>(i)] = runs[used[i]].y[o];
    p_ = best_surface(ranges_, places, y);
    for (std::size_t i = 0; i < used.size(); ++i) residual_[used[i]] = p_.left[static_cast<Eigen::Index>(i)];
    freedom_ = static_cast<double>(y.size() - p_.c.size());
    scatter_ = std::sqrt(p_.left.squaredNorm() / freedom_);
  }

  struct Value {
    double y, leverage, slope;  ///< slope: derivative by the condition
  };
  [[nodiscard]] Value at(const std::vector<double>& theta) const {
    if (!condition_) return value(theta, 0);
    const double step = 0.01 * (condition_->tried.upper - condition_->tried.lower);
    Value v = value(theta, 0);
    v.slope = (value(theta, step).y - value(theta, -step).y) / (2 * step);
    return v;
  }
  [[nodiscard]] double scatter() const { return scatter_; }
  [[nodiscard]] double freedom() const { return freedom_; }
  [[nodiscard]] bool shares_runs() const { return !condition_; }
  [[nodiscard]] const std::vector<double>& residual() const { return residual_; }

 private:
  [[nodiscard]] Value value(std::vector<double> x, double away) const {
    if (condition_) x.push_back(condition_->value + away);
    const Eigen::VectorXd t = terms(ranges_, x, p_.degree);
    return {t.dot(p_.c), t.dot(p_.spread * t), 0};
  }

  std::vector<Sought> ranges_;
  std::optional<Condition> condition_;
  std::vector<double> residual_;  ///< of each run; NaN if the run has no value
  Polynomial p_;
  double scatter_ = 0, freedom_ = 0;
};

/// Correlation of the residuals of two observables over the runs that have both.
double correlation(const Surface& a, const Surface& b) {
  if (!a.shares_runs() || !b.shares_runs()) return 0;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.residual().size(); ++i) {
    const double x = a.residual()[i], y = b.residual()[i];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    ab += x * y, aa += x * x, bb += y * y;
  }
  // Limited below 1, so that the same observable under two names does not make the covariance singular.
  return aa > 0 && bb > 0 ? std::clamp(ab / std::sqrt(aa * bb), -1 + 1e-6, 1 - 1e-6) : 0;
}

/// chi^2(theta) as defined in inference.hpp.
class ChiSquared {
 public:
  ChiSquared(const std::vector<Surface>& surfaces, const std::vector<MeasuredObservable>& measured)
      : surfaces_(surfaces), measured_(measured) {
    const auto n = static_cast<Eigen::Index>(surfaces.size());
    correlation_ = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        correlation_(i, j) = correlation_(j, i) =
            correlation(surfaces[static_cast<std::size_t>(i)], surfaces[static_cast<std::size_t>(j)]);
  }
  [[nodiscard]] double operator()(const std::vector<double>& theta) const {
    const auto n = static_cast<Eigen::Index>(surfaces_.size());
    Eigen::VectorXd d(n), s(n), own(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Surface& surface = surfaces_[static_cast<std::size_t>(i)];
      const MeasuredObservable& m = measured_[static_cast<std::size_t>(i)];
      const Surface::Value v = surface.at(theta);
      d[i] = v.y - m.value;
      s[i] = surface.scatter() * std::sqrt(1 + v.leverage);
      own[i] = std::max(m.error * m.error - surface.scatter() * surface.scatter(), 0.0) +
               (m.at ? std::pow(v.slope * m.at->error, 2) : 0);
    }
    Eigen::MatrixXd covariance = s.asDiagonal() * correlation_ * s.asDiagonal();
    covariance.diagonal() += own.cwiseMax(1e-24 * (1 + d.array().square()).matrix());
    return d.dot(covariance.ldlt().solve(d));
  }

 private:
  const std::vector<Surface>& surfaces_;
  const std::vector<MeasuredObservable>& measured_;
  Eigen::MatrixXd correlation_;
};

/// Rise of chi^2 above its minimum at the ends of the 95 % interval, by Student's t with Hotelling's
/// correction.
double drop_of(const std::vector<Surface>& surfaces) {
  double freedom = HUGE_VAL, together = 0;
  for (const Surface& s : surfaces) {
    freedom = std::min(freedom, s.freedom());
    together += s.shares_runs() ? 1 : 0;
  }
  const double left = freedom - std::max(together, 1.0) + 1;
  if (left < 2)
    throw InputError({.file = {}, .key = "runs"},
                     fmt::format("{:g} observables of the same runs need {} more.", together,
                                 plural(static_cast<int>(std::ceil(2 - left)), "run")));
  const double t95 = boost::math::quantile(boost::math::students_t(left), 0.975);
  return t95 * t95 * freedom / left;
}

/// chi^2 on a grid over all parameters. There are few of them, so the full grid is cheap.
struct GridSearch {
  int steps = 0;
  std::vector<std::vector<double>> least;  ///< [parameters][steps + 1], minimum over all other parameters
  std::vector<double> best;
  double chi2 = HUGE_VAL;  ///< at the best point
};
GridSearch search(const std::vector<Sought>& sought, const ChiSquared& chi2, int coarser) {
  GridSearch g;
  g.steps = (sought.size() == 1 ? 20 * kSteps : sought.size() == 2 ? kSteps * 2 : 24) / coarser;
  g.least.assign(sought.size(), std::vector<double>(static_cast<std::size_t>(g.steps) + 1, HUGE_VAL));
  std::vector<double> theta(sought.size());
  std::vector<int> at(sought.size(), 0);
  const std::function<void(std::size_t)> walk = [&](std::size_t k) {
    if (k == sought.size()) {
      const double c = chi2(theta);
      for (std::size_t i = 0; i < sought.size(); ++i) {
        double& slot = g.least[i][static_cast<std::size_t>(at[i])];
        slot = std::min(slot, c);
      }
      if (c < g.chi2) {
        g.chi2 = c;
        g.best = theta;
      }
      return;
    }
    for (at[k] = 0; at[k] <= g.steps; ++at[k]) {
      theta[k] = sought[k].lower + (sought[k].upper - sought[k].lower) * at[k] / g.steps;
      walk(k + 1);
    }
  };
  walk(0);
  return g;
}

/// Leave-one-run-out test: the run replaces the measurement, and the surfaces are fitted to all other runs.
/// \returns for each parameter, the rise of the profile above its minimum at the run's own parameter value
std::vector<double> excess_of(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                              std::vector<MeasuredObservable> measured, std::size_t run) {
  std::vector<SimulatedPoint> others = runs;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(run));
  std::vector<Surface> surfaces;
  for (std::size_t o = 0; o < measured.size(); ++o) {
    measured[o].value = runs[run].y[o];
    measured[o].error = 0;
    if (measured[o].at) measured[o].at->value = runs[run].at[o], measured[o].at->error = 0;
    surfaces.emplace_back(sought, others, o, measured[o]);
  }
  const GridSearch g = search(sought, ChiSquared(surfaces, measured), 2);
  std::vector<double> excess;
  for (std::size_t i = 0; i < sought.size(); ++i) {
    const double x = (runs[run].theta[i] - sought[i].lower) / (sought[i].upper - sought[i].lower) * g.steps;
    const auto slot =
        static_cast<std::size_t>(std::clamp(std::llround(x), 0LL, static_cast<long long>(g.steps)));
    excess.push_back(g.least[i][slot] - g.chi2);
  }
  return excess;
}

/// Rise of chi^2 at the ends of each parameter's interval: the value by Student's t, or larger if fewer than
/// 95 % of the runs, taken as the measurement in turn, have their own parameter inside. Beds have long-tailed
/// scatter, which is larger at one end of a range than at the other: with t alone, 25 of 30 runs were inside.
std::vector<double> drops_of(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                             const std::vector<MeasuredObservable>& measured, double by_t) {
  std::vector<std::vector<double>> excess(sought.size());
  // The test needs enough other runs to fit the surfaces.
  const auto spare = [&](std::size_t o) {
    const auto have = std::count_if(runs.begin(), runs.end(),
                                    [&](const SimulatedPoint& r) { return std::isfinite(r.y[o]); });
    return static_cast<std::size_t>(have) > Surface::fewest(sought.size() + (measured[o].at ? 1 : 0));
  };
  bool enough = true;
  for (std::size_t o = 0; o < measured.size(); ++o) enough = enough && spare(o);
  for (std::size_t k = 0; enough && k < runs.size(); ++k) {
    if (!std::all_of(runs[k].y.begin(), runs[k].y.end(), [](double y) { return std::isfinite(y); })) continue;
    const std::vector<double> own = excess_of(sought, runs, measured, k);
    for (std::size_t i = 0; i < sought.size(); ++i) excess[i].push_back(own[i]);
  }
  std::vector<double> drops;
  for (std::vector<double>& e : excess) {
    std::sort(e.begin(), e.end());
    if (e.empty()) e = {by_t};
    const double rank = 0.95 * static_cast<double>(e.size() + 1) - 1;  // interpolated between two values
    const auto below = std::min(static_cast<std::size_t>(std::max(rank, 0.0)), e.size() - 1);
    const double own = std::lerp(e[below], e[std::min(below + 1, e.size() - 1)],
                                 std::min(1.0, rank - static_cast<double>(below)));
    // Never below the value by t: the runs of the test are few and also made the surfaces.
    drops.push_back(std::max(by_t, own));
  }
  return drops;
}

}  // namespace

std::vector<std::vector<double>> spread_points(const std::vector<Sought>& sought, int n) {
  constexpr std::array kPrimes = {2, 3, 5, 7, 11, 13};
  std::vector<std::vector<double>> points;
  for (int i = 1; i <= n; ++i) {
    std::vector<double> theta;
    for (std::size_t k = 0; k < sought.size(); ++k) {
      double x = 0, f = 1;
      for (int j = i; j > 0; j /= kPrimes.at(k)) {
        f /= kPrimes.at(k);
        x += f * (j % kPrimes.at(k));
      }
      theta.push_back(sought[k].lower + x * (sought[k].upper - sought[k].lower));
    }
    points.push_back(theta);
  }
  return points;
}

Inference infer_parameters(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                           const std::vector<MeasuredObservable>& measured) {
  if (runs.empty() || sought.empty() || measured.empty())
    throw InputError({.file = {}, .key = "runs"}, "runs, parameters and observables are needed.");
  Inference out;
  std::vector<Surface> surfaces;
  for (std::size_t o = 0; o < measured.size(); ++o) {
    surfaces.emplace_back(sought, runs, o, measured[o]);
    out.scatter.push_back(surfaces.back().scatter());
  }
  const ChiSquared chi2(surfaces, measured);
  const GridSearch all = search(sought, chi2, 1);
  out.chi2 = all.chi2;
  const std::vector<double> drops = drops_of(sought, runs, measured, drop_of(surfaces));
  out.freedom = static_cast<double>(measured.size()) - static_cast<double>(sought.size());
  for (std::size_t i = 0; i < sought.size(); ++i) {
    const double drop = drops[i];
    Profile p{.sought = sought[i], .best = all.best[i], .drop = drop};
    bool inside = false;
    for (int k = 0; k <= all.steps; ++k) {
      const double x = sought[i].lower + (sought[i].upper - sought[i].lower) * k / all.steps;
      const double c = all.least[i][static_cast<std::size_t>(k)];
      p.at.push_back(x);
      p.chi2.push_back(c);
      if (c <= out.chi2 + drop) {
        if (!inside) p.low = x;
        p.high = x;
        inside = true;
      }
    }
    p.open_low = p.low == sought[i].lower;
    p.open_high = p.high == p.at.back();
    p.standard_error = p.open_low || p.open_high ? kNaN : (p.high - p.low) / (2 * analysis::kStandardErrors);
    if (p.undetermined())
      out.notes.push_back(
          fmt::format("{} is undetermined: all values between {:g} and {:g} agree with the measurement",
                      sought[i].name, sought[i].lower, sought[i].upper));
    else if (p.open_low || p.open_high)
      out.notes.push_back(fmt::format(
          "{} is only bounded: {} {:.4g} at 95 %; the other end of the search range is not excluded",
          sought[i].name, p.open_low ? "below" : "above", p.open_low ? p.high : p.low));
    out.profiles.push_back(std::move(p));
  }
  for (const Surface& s : surfaces) {
    const Surface::Value v = s.at(all.best);
    out.predicted.push_back(v.y);
    out.slope.push_back(v.slope);
  }
  if (is_beyond_errors(out.chi2, out.freedom))
    out.notes.push_back(
        fmt::format("no parameters in the search range describe the measurement: chi^2 = {:.3g} of {:g}",
                    out.chi2, out.freedom));
  return out;
}

}  // namespace twincell::calibration
