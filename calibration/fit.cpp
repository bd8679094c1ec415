#include "calibration/fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace twincell {
namespace {

constexpr double kLargestCondition = 1e12;

/// J at the solution, dense: our problems have few parameters.
Eigen::MatrixXd jacobian_at(ceres::Problem& problem) {
  ceres::CRSMatrix sparse;
  problem.Evaluate(ceres::Problem::EvaluateOptions(), nullptr, nullptr, nullptr, &sparse);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row)
    for (int e = sparse.rows[static_cast<std::size_t>(row)];
         e < sparse.rows[static_cast<std::size_t>(row) + 1]; ++e)
      dense(row, sparse.cols[static_cast<std::size_t>(e)]) = sparse.values[static_cast<std::size_t>(e)];
  return dense;
}

void add_covariance(FitReport& report, const Eigen::MatrixXd& jacobian, Residuals residuals) {
  const Eigen::Index n = jacobian.cols();
  // Columns scaled to length 1, so that the condition number does not depend on the parameters' units.
  Eigen::VectorXd scale(n);
  for (Eigen::Index c = 0; c < n; ++c) scale[c] = jacobian.col(c).norm();
  if (scale.minCoeff() <= 0) {
    report.condition = std::numeric_limits<double>::infinity();
    report.why_not = "a parameter has no influence on the residuals";
    return;
  }
  const Eigen::MatrixXd scaled = jacobian * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  report.condition = s[0] * s[0] / (s[s.size() - 1] * s[s.size() - 1]);
  if (!(report.condition <= kLargestCondition)) {
    report.why_not =
        fmt::format("the data do not tell the parameters apart (condition number {:.1e})", report.condition);
    return;
  }
  double variance = 1;
  if (residuals == Residuals::unweighted) {
    const Eigen::Index freedom = jacobian.rows() - n;
    if (freedom <= 0) {
      report.why_not = "as many parameters as residuals: values without errors";
      return;
    }
    variance = 2 * report.cost_after / static_cast<double>(freedom);
  }
  const Eigen::MatrixXd inverse =
      svd.matrixV() * s.cwiseProduct(s).cwiseInverse().asDiagonal() * svd.matrixV().transpose();
  report.covariance =
      variance * (scale.cwiseInverse().asDiagonal() * inverse * scale.cwiseInverse().asDiagonal());
  for (Eigen::Index c = 0; c < n; ++c) report.standard_errors.push_back(std::sqrt(report.covariance(c, c)));
}

}  // namespace

double FitReport::rms() const {
  return n_residuals > 0 ? std::sqrt(2 * cost_after / n_residuals) : std::numeric_limits<double>::quiet_NaN();
}

double FitReport::value(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  assert(found != names.end());
  return values[static_cast<std::size_t>(found - names.begin())];
}

double FitReport::standard_error(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  assert(found != names.end());
  if (standard_errors.empty()) return std::numeric_limits<double>::quiet_NaN();
  return standard_errors[static_cast<std::size_t>(found - names.begin())];
}

FitReport solve(ceres::Problem& problem, double* parameters, const std::vector<std::string>& names,
                Residuals residuals) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.minimizer_progress_to_stdout = false;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-15;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  FitReport report;
  report.names = names;
  report.values.assign(parameters, parameters + names.size());
  report.n_residuals = problem.NumResiduals();
  report.cost_before = summary.initial_cost;
  report.cost_after = summary.final_cost;
  report.stop_reason = summary.message;
  report.usable = summary.IsSolutionUsable();
  if (!report.usable) {
    report.why_not = summary.message;
    return report;
  }
  add_covariance(report, jacobian_at(problem), residuals);
  return report;
}

}  // namespace twincell
