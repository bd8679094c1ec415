#pragma once
/// \file
/// Templates that turn a formula into a Law, shared by the files of this folder. Not installed, because it
/// needs Ceres.

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "calibration/fit/law.hpp"

namespace twincell::calibration {

/// Residual (Model::value(x, p) - y)/error.
template <class Model>
struct ModelResidual {
  FitPoint point;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    residual[0] = (Model::value(point.x, p) - point.y) / point.error;
    return true;
  }
};

/// Adds value and residual of Model to `law`. A Model has `template <class T> static T value(double x, const
/// T* p)` for `Model::kParameters` parameters.
template <class Model>
Law make_law(Law law) {
  law.value = [](double x, const double* p) { return Model::value(x, p); };
  law.residual = [](const FitPoint& point) -> ceres::CostFunction* {
    return new ceres::AutoDiffCostFunction<ModelResidual<Model>, 1, Model::kParameters>(
        new ModelResidual<Model>{point});
  };
  return law;
}

/// Basis functions of x.
using Basis = std::vector<std::function<double(double)>>;

/// Coefficients of `basis` by linear least squares, and the sum of squared residuals in units of the errors.
inline std::pair<std::vector<double>, double> least_squares(const std::vector<FitPoint>& points,
                                                            const Basis& basis) {
  const auto rows = static_cast<Eigen::Index>(points.size()),
             columns = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd matrix(rows, columns);
  Eigen::VectorXd y(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const FitPoint& p = points[static_cast<std::size_t>(i)];
    for (Eigen::Index c = 0; c < columns; ++c)
      matrix(i, c) = basis[static_cast<std::size_t>(c)](p.x) / p.error;
    y[i] = p.y / p.error;
  }
  const Eigen::VectorXd weights = matrix.colPivHouseholderQr().solve(y);
  return {{weights.begin(), weights.end()}, (matrix * weights - y).squaredNorm()};
}

/// Best continuous line in u(x) with a bend at u = bend: {value at the bend, slope below, slope above} with
/// respect to u, and its sum of squared residuals.
inline std::pair<std::vector<double>, double> bent_line(const std::vector<FitPoint>& points,
                                                        const std::function<double(double)>& u_of,
                                                        double bend) {
  return least_squares(points,
                       {[](double) { return 1.0; }, [&](double x) { return std::min(u_of(x) - bend, 0.0); },
                        [&](double x) { return std::max(u_of(x) - bend, 0.0); }});
}

/// Starts for a line in u(x) with a bend: one for each gap between neighbouring u that has two points on
/// either side, as {value at the bend, slope below, slope above, u of the bend}, slopes with respect to u.
inline std::vector<std::vector<double>> bend_starts(const std::vector<FitPoint>& points,
                                                    const std::function<double(double)>& u_of) {
  std::vector<double> u;
  for (const FitPoint& p : points) u.push_back(u_of(p.x));
  std::sort(u.begin(), u.end());
  u.erase(std::unique(u.begin(), u.end()), u.end());
  std::vector<std::vector<double>> starts;
  for (std::size_t i = 1; i + 2 < u.size(); ++i) {
    const double bend = (u[i] + u[i + 1]) / 2;
    std::vector<double> w = bent_line(points, u_of, bend).first;
    w.push_back(bend);
    starts.push_back(std::move(w));
  }
  return starts;
}

/// Starts for y = a + d shape(b, x): the linear coefficients for each b in `rates`; the three best are
/// returned as {a, b, d/a}.
inline std::vector<std::vector<double>> decay_starts(const std::vector<FitPoint>& points,
                                                     const std::vector<double>& rates,
                                                     const std::function<double(double, double)>& shape) {
  std::vector<std::pair<double, std::vector<double>>> tried;
  for (const double b : rates) {
    const auto [w, cost] =
        least_squares(points, {[](double) { return 1.0; }, [&](double x) { return shape(b, x); }});
    if (w[0] != 0) tried.push_back({cost, {w[0], b, w[1] / w[0]}});
  }
  std::sort(tried.begin(), tried.end());
  std::vector<std::vector<double>> starts;
  for (const auto& [cost, start] : tried)
    if (starts.size() < 3) starts.push_back(start);
  return starts;
}

}  // namespace twincell::calibration
