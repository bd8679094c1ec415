#include "calibration/inference.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "analysis/trajectory/error.hpp"

namespace twincell {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kSteps = 60;  // of a profile

/// 1, x_i, x_i x_k with x from -1 to 1 over the ranges.
Eigen::VectorXd terms(const std::vector<Sought>& ranges, const std::vector<double>& theta) {
  const std::size_t n = ranges.size();
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = 2 * (theta[i] - ranges[i].lower) / (ranges[i].upper - ranges[i].lower) - 1;
  Eigen::VectorXd out(static_cast<Eigen::Index>(1 + n + n * (n + 1) / 2));
  Eigen::Index k = 0;
  out[k++] = 1;
  for (std::size_t i = 0; i < n; ++i) out[k++] = x[i];
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) out[k++] = x[i] * x[j];
  return out;
}

/// One observable as a function of the parameters, with its condition as the last of them.
class Surface {
 public:
  Surface(std::vector<Sought> sought, const std::vector<SimulatedPoint>& runs, std::size_t o,
          const MeasuredObservable& measured)
      : ranges_(std::move(sought)), condition_(measured.at), residual_(runs.size(), kNaN) {
    if (condition_) ranges_.push_back(condition_->tried);
    const auto place = [&](const SimulatedPoint& run) {
      std::vector<double> x = run.theta;
      if (condition_) x.push_back(run.at[o]);
      return terms(ranges_, x);
    };
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < runs.size(); ++i)
      if (std::isfinite(runs[i].y[o])) used.push_back(i);
    const Eigen::Index n = place(runs.front()).size();
    if (static_cast<Eigen::Index>(used.size()) < n + 2)
      throw InputError({.file = {}, .key = "runs"},
                       fmt::format("{} of {} runs have a value of {}; its quadratic surface needs {}.",
                                   used.size(), runs.size(), measured.name, n + 2));
    Eigen::MatrixXd basis(static_cast<Eigen::Index>(used.size()), n);
    Eigen::VectorXd y(static_cast<Eigen::Index>(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i) {
      basis.row(static_cast<Eigen::Index>(i)) = place(runs[used[i]]).transpose();
      y[static_cast<Eigen::Index>(i)] = runs[used[i]].y[o];
    }
    c_ = basis.colPivHouseholderQr().solve(y);
    const Eigen::VectorXd left = y - basis * c_;
    for (std::size_t i = 0; i < used.size(); ++i) residual_[used[i]] = left[static_cast<Eigen::Index>(i)];
    freedom_ = static_cast<double>(basis.rows() - n);
    scatter_ = std::sqrt(left.squaredNorm() / freedom_);
    spread_ = (basis.transpose() * basis).inverse();
  }

  struct Value {
    double y, leverage, slope;  ///< slope: against the condition
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
    const Eigen::VectorXd t = terms(ranges_, x);
    return {t.dot(c_), t.dot(spread_ * t), 0};
  }

  std::vector<Sought> ranges_;
  std::optional<Condition> condition_;
  std::vector<double> residual_;  ///< of each run; NaN where it has no value
  Eigen::VectorXd c_;
  Eigen::MatrixXd spread_;  ///< covariance of c over the scatter squared
  double scatter_ = 0, freedom_ = 0;
};

/// How the residuals of two observables go together in the runs that have both.
double correlation(const Surface& a, const Surface& b) {
  if (!a.shares_runs() || !b.shares_runs()) return 0;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.residual().size(); ++i) {
    const double x = a.residual()[i], y = b.residual()[i];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    ab += x * y, aa += x * x, bb += y * y;
  }
  // Short of 1, so that two names of one observable do not make the covariance singular.
  return aa > 0 && bb > 0 ? std::clamp(ab / std::sqrt(aa * bb), -1 + 1e-6, 1 - 1e-6) : 0;
}

/// chi^2 of the docstring.
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

/// By how much chi^2 may exceed its least within the 95 % interval.
double drop_of(const std::vector<Surface>& surfaces) {
  double freedom = HUGE_VAL, together = 0;
  for (const Surface& s : surfaces) {
    freedom = std::min(freedom, s.freedom());
    together += s.shares_runs() ? 1 : 0;
  }
  const double left = freedom - std::max(together, 1.0) + 1;
  if (left < 2)
    throw InputError(
        {.file = {}, .key = "runs"},
        fmt::format("{:g} observables of the same runs need {:g} runs more.", together, 2 - left));
  const double t95 = boost::math::quantile(boost::math::students_t(left), 0.975);
  return t95 * t95 * freedom / left;
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
  const double drop = drop_of(surfaces);
  // A grid over all parameters: few, and chi^2 costs nothing.
  const int steps = sought.size() == 1 ? 20 * kSteps : sought.size() == 2 ? kSteps * 2 : 24;
  std::vector<std::vector<double>> least(sought.size(),
                                         std::vector<double>(static_cast<std::size_t>(steps) + 1, HUGE_VAL));
  std::vector<double> theta(sought.size()), best(sought.size());
  std::vector<int> at(sought.size(), 0);
  out.chi2 = HUGE_VAL;
  const std::function<void(std::size_t)> walk = [&](std::size_t k) {
    if (k == sought.size()) {
      const double c = chi2(theta);
      for (std::size_t i = 0; i < sought.size(); ++i) {
        double& slot = least[i][static_cast<std::size_t>(at[i])];
        slot = std::min(slot, c);
      }
      if (c < out.chi2) {
        out.chi2 = c;
        best = theta;
      }
      return;
    }
    for (at[k] = 0; at[k] <= steps; ++at[k]) {
      theta[k] = sought[k].lower + (sought[k].upper - sought[k].lower) * at[k] / steps;
      walk(k + 1);
    }
  };
  walk(0);
  out.freedom = static_cast<double>(measured.size()) - static_cast<double>(sought.size());
  for (std::size_t i = 0; i < sought.size(); ++i) {
    Profile p{.sought = sought[i], .best = best[i]};
    bool inside = false;
    for (int k = 0; k <= steps; ++k) {
      const double x = sought[i].lower + (sought[i].upper - sought[i].lower) * k / steps;
      const double c = least[i][static_cast<std::size_t>(k)];
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
    p.standard_error = p.open_low || p.open_high ? kNaN : (p.high - p.low) / (2 * std::sqrt(drop));
    if (p.undetermined())
      out.notes.push_back(
          fmt::format("{} is undetermined: nothing between {:g} and {:g} contradicts what was measured",
                      sought[i].name, sought[i].lower, sought[i].upper));
    else if (p.open_low || p.open_high)
      out.notes.push_back(
          fmt::format("{} is only bounded: {} {:.4g} at 95 %; the other end of what was looked at fits",
                      sought[i].name, p.open_low ? "below" : "above", p.open_low ? p.high : p.low));
    out.profiles.push_back(std::move(p));
  }
  for (const Surface& s : surfaces) {
    const Surface::Value v = s.at(best);
    out.predicted.push_back(v.y);
    out.slope.push_back(v.slope);
  }
  if (out.freedom > 0 && out.chi2 > out.freedom + 3 * std::sqrt(2 * out.freedom) + 4)
    out.notes.push_back(fmt::format(
        "no parameters looked at describe the measurement: chi^2 = {:.3g} of {:g}", out.chi2, out.freedom));
  return out;
}

}  // namespace twincell
