#include "calibration/curves.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/trajectory/error.hpp"

namespace twincell {
namespace {

/// A point of a straight line, in the transformed coordinates.
struct LinePoint {
  double x, y;
  double error;  ///< standard deviation of y, or 1 if unknown
};

/// (a + b (x - origin) - y)/error.
struct Line {
  LinePoint point;
  double origin;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    residual[0] = (p[0] + p[1] * (point.x - origin) - point.y) / point.error;
    return true;
  }
};

/// Sorts points into used, zero, outside and invalid. `x`, `y` of a point, `add` one that is used.
template <class Point, class X, class Y, class Add>
void select(const std::vector<Point>& points, const FitWindow& window, CurveFit& fit, const X& x, const Y& y,
            const Add& add) {
  double low = INFINITY, high = -INFINITY;
  for (const Point& p : points) {
    if (!std::isfinite(x(p)) || !std::isfinite(y(p)) || x(p) <= 0 || y(p) < 0) {
      ++fit.n_invalid;
      continue;
    }
    low = std::min(low, x(p));
    high = std::max(high, x(p));
    if (x(p) < window.low || x(p) > window.high)
      ++fit.n_outside;
    else if (y(p) == 0)
      ++fit.n_zero;
    else {
      ++fit.n_used;
      add(p);
    }
  }
  if (fit.n_used > 0) return;
  throw InputError({.file = {}, .key = "window"},
                   low > high ? std::string("there is no valid point to fit")
                              : fmt::format("no point with a positive ordinate lies in [{:g}, {:g}]; the "
                                            "data span [{:g}, {:g}], {} of them are zero",
                                            window.low, window.high, low, high, fit.n_zero));
}

/// Fits y = a + b x. The origin is moved to the middle of the data for the solution and back for the report,
/// which keeps the parameters' digits when the data lie far from 0.
void fit_line(const std::vector<LinePoint>& points, bool weighted, CurveFit& result,
              const std::string& a_name, const std::string& b_name, double b_sign) {
  const auto [least, most] = std::minmax_element(
      points.begin(), points.end(), [](const LinePoint& p, const LinePoint& q) { return p.x < q.x; });
  if (!(most->x > least->x))
    throw InputError(
        {.file = {}, .key = "points"},
        fmt::format("a line needs at least 2 different abscissas; {} points have the same", points.size()));
  const double origin = (least->x + most->x) / 2;
  std::array<double, 2> p = {points.front().y, 0};
  ceres::Problem problem;
  for (const LinePoint& point : points)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Line, 1, 2>(new Line{point, origin}), nullptr,
                             p.data());
  FitReport& fit = result.fit;
  fit = solve(problem, p.data(), {a_name, b_name}, weighted ? Residuals::weighted : Residuals::unweighted);
  Eigen::Matrix2d back;
  back << 1, -origin, 0, b_sign;
  const Eigen::Vector2d values = back * Eigen::Vector2d(p[0], p[1]);
  fit.values = {values[0], values[1]};
  if (fit.covariance.size() > 0) {
    fit.covariance = (back * fit.covariance * back.transpose()).eval();
    fit.standard_errors = {std::sqrt(fit.covariance(0, 0)), std::sqrt(fit.covariance(1, 1))};
  }
  if (points.size() == 2 && !weighted) result.flag = "two points: values without errors";
  if (std::all_of(points.begin(), points.end(), [&](const LinePoint& q) { return q.y == points.front().y; }))
    result.flag = "constant ordinate";
}

}  // namespace

CurveFit fit_arrhenius(const std::vector<SlipPoint>& points, const FitWindow& window) {
  const bool weighted =
      std::all_of(points.begin(), points.end(), [](const SlipPoint& p) { return p.trials > 0 && p.p_s < 1; });
  CurveFit result;
  std::vector<LinePoint> line;
  select(
      points, window, result, [](const SlipPoint& p) { return p.k_m; },
      [](const SlipPoint& p) { return p.p_s; },
      [&](const SlipPoint& p) {
        line.push_back(
            {1 / p.k_m, std::log(p.p_s), weighted ? std::sqrt((1 - p.p_s) / (p.p_s * p.trials)) : 1.0});
      });
  fit_line(line, weighted, result, "c", "E_b", -1);
  return result;
}

std::vector<double> upper_limits(const std::vector<SlipPoint>& points) {
  std::vector<double> limits;
  for (const SlipPoint& p : points)
    if (p.p_s == 0 && p.trials > 0) limits.push_back(3 / p.trials);
  return limits;
}

CurveFit fit_power_law(const std::vector<CurvePoint>& points, const FitWindow& window) {
  CurveFit result;
  std::vector<LinePoint> line;
  select(
      points, window, result, [](const CurvePoint& p) { return p.x; },
      [](const CurvePoint& p) { return p.y; },
      [&](const CurvePoint& p) {
        line.push_back({std::log(p.x), std::log(p.y), 1.0});
      });
  fit_line(line, false, result, "ln_C", "alpha", 1);
  return result;
}

}  // namespace twincell
