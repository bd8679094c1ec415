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
Eigen::VectorXd terms(const std::vector<Sought>& sought, const std::vector<double>& theta) {
  const std::size_t n = sought.size();
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = 2 * (theta[i] - sought[i].lower) / (sought[i].upper - sought[i].lower) - 1;
  Eigen::VectorXd out(static_cast<Eigen::Index>(1 + n + n * (n + 1) / 2));
  Eigen::Index k = 0;
  out[k++] = 1;
  for (std::size_t i = 0; i < n; ++i) out[k++] = x[i];
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) out[k++] = x[i] * x[j];
  return out;
}

struct Surface {
  Eigen::VectorXd c;
  Eigen::MatrixXd covariance;  // of c
  double scatter = 0;
  double freedom = 0;  // runs beyond the coefficients: how well the scatter is known
};

Surface fit_surface(const std::vector<Sought>& sought, const std::vector<SimulatedPoint>& runs,
                    std::size_t o) {
  std::vector<const SimulatedPoint*> used;
  for (const SimulatedPoint& r : runs)
    if (std::isfinite(r.y[o])) used.push_back(&r);
  const Eigen::Index n = terms(sought, runs.front().theta).size();
  if (static_cast<Eigen::Index>(used.size()) < n + 2)
    throw InputError({.file = {}, .key = "runs"},
                     fmt::format("{} of {} runs have a value; a quadratic surface needs {}.", used.size(),
                                 runs.size(), n + 2));
  Eigen::MatrixXd basis(static_cast<Eigen::Index>(used.size()), n);
  Eigen::VectorXd y(static_cast<Eigen::Index>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i) {
    basis.row(static_cast<Eigen::Index>(i)) = terms(sought, used[i]->theta).transpose();
    y[static_cast<Eigen::Index>(i)] = used[i]->y[o];
  }
  Surface s;
  s.c = basis.colPivHouseholderQr().solve(y);
  const double variance = (y - basis * s.c).squaredNorm() / static_cast<double>(basis.rows() - n);
  s.scatter = std::sqrt(variance);
  s.freedom = static_cast<double>(basis.rows() - n);
  s.covariance = variance * (basis.transpose() * basis).inverse();
  return s;
}

}  // namespace

std::vector<std::vector<double>> spread_points(const std::vector<Sought>& sought, int n) {
  constexpr std::array kPrimes = {2, 3, 5, 7};
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
    surfaces.push_back(fit_surface(sought, runs, o));
    out.scatter.push_back(surfaces.back().scatter);
  }
  const auto chi2 = [&](const std::vector<double>& theta) {
    const Eigen::VectorXd t = terms(sought, theta);
    double sum = 0;
    for (std::size_t o = 0; o < measured.size(); ++o) {
      const Surface& s = surfaces[o];
      // The measurement is one run too: where its own error is smaller than what runs scatter, the scatter
      // counts.
      const double e2 =
          std::max(measured[o].error * measured[o].error, s.scatter * s.scatter) + t.dot(s.covariance * t);
      sum += std::pow(t.dot(s.c) - measured[o].value, 2) / std::max(e2, 1e-300);
    }
    return sum;
  };
  // The scatter is itself known from so many runs only: Student's t in place of 1.96.
  double freedom = HUGE_VAL;
  for (const Surface& s : surfaces) freedom = std::min(freedom, s.freedom);
  const double t95 = boost::math::quantile(boost::math::students_t(freedom), 0.975), drop = t95 * t95;
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
    p.standard_error = p.open_low || p.open_high ? kNaN : (p.high - p.low) / (2 * t95);
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
  const Eigen::VectorXd t = terms(sought, best);
  for (const Surface& s : surfaces) out.predicted.push_back(t.dot(s.c));
  if (out.freedom > 0 && out.chi2 > out.freedom + 3 * std::sqrt(2 * out.freedom) + 4)
    out.notes.push_back(fmt::format(
        "no parameters looked at describe the measurement: chi^2 = {:.3g} of {:g}", out.chi2, out.freedom));
  return out;
}

}  // namespace twincell
