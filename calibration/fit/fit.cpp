#include "calibration/fit/fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>
#if __has_include(<glog/logging.h>)
#include <glog/logging.h>
#define TWINCELL_HAS_GLOG
#endif

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace twincell::calibration {
namespace {

constexpr double kLargestCondition = 1e12;
/// A parameter is undetermined if its component in an undetermined direction exceeds this value.
constexpr double kLargeShare = 0.1;

/// Jacobian at the present parameters, dense because the problems have few parameters.
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
  // Scale columns to unit length, so that the condition number does not depend on the parameters' units.
  Eigen::VectorXd scale(n);
  for (Eigen::Index c = 0; c < n; ++c) scale[c] = jacobian.col(c).norm();
  if (scale.minCoeff() <= 0) {
    report.condition = std::numeric_limits<double>::infinity();
    for (Eigen::Index c = 0; c < n; ++c)
      if (scale[c] <= 0) report.undetermined.push_back(report.names[static_cast<std::size_t>(c)]);
    report.why_not =
        fmt::format("{} has no influence on the residuals", fmt::join(report.undetermined, ", "));
    return;
  }
  const Eigen::MatrixXd scaled = jacobian * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  report.condition = s[0] * s[0] / (s[s.size() - 1] * s[s.size() - 1]);
  if (!(report.condition <= kLargestCondition)) {
    for (Eigen::Index c = 0; c < n; ++c) {
      bool open = false;
      for (Eigen::Index d = 0; d < n; ++d)
        open = open || (!(s[0] * s[0] <= kLargestCondition * s[d] * s[d]) &&
                        std::abs(svd.matrixV()(c, d)) > kLargeShare);
      if (open) report.undetermined.push_back(report.names[static_cast<std::size_t>(c)]);
    }
    report.why_not = fmt::format("the data do not separate {} (condition number {:.1e})",
                                 fmt::join(report.undetermined, ", "), report.condition);
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

/// Largest cosine of the angle between the residuals and a column of J: 0 at a minimum, independent of units;
/// infinite where the law has no finite value.
double slope_left(ceres::Problem& problem) {
  std::vector<double> residuals;
  if (!problem.Evaluate(ceres::Problem::EvaluateOptions(), nullptr, &residuals, nullptr, nullptr))
    return std::numeric_limits<double>::infinity();
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
  const Eigen::MatrixXd jacobian = jacobian_at(problem);
  if (!jacobian.allFinite()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    const double length = jacobian.col(c).norm() * r.norm();
    if (length > 0) largest = std::max(largest, std::abs(jacobian.col(c).dot(r)) / length);
  }
  return largest;
}

/// Final Gauss-Newton steps. Ceres stops when the sum of squares no longer changes, at half of the
/// parameters' digits. The gradient still converges beyond that point.
void polish(ceres::Problem& problem, double* parameters, std::size_t n) {
  double left = slope_left(problem);
  for (int step = 0; step < 100; ++step) {
    std::vector<double> residuals;
    problem.Evaluate(ceres::Problem::EvaluateOptions(), nullptr, &residuals, nullptr, nullptr);
    const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
    const Eigen::VectorXd delta = jacobian_at(problem).colPivHouseholderQr().solve(r);
    const std::vector<double> before(parameters, parameters + n);
    for (std::size_t p = 0; p < n; ++p) parameters[p] -= delta[static_cast<Eigen::Index>(p)];
    const double now = slope_left(problem);
    if (!(now < left)) {
      std::copy(before.begin(), before.end(), parameters);
      return;
    }
    left = now;
  }
}

/// If slope_left is below this, the start is the minimum to working precision.
constexpr double kAtMinimum = 1e-11;

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

namespace {

constexpr int kMaxIterations = 2000;
constexpr double kTolerance = 1e-15;

/// Reason in the program's own words, because Ceres's messages contain memory addresses.
std::string why_stopped(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE:
      return fmt::format(
          "The relative change of the sum of squares, its gradient or the parameters fell below {:g}.",
          kTolerance);
    case ceres::NO_CONVERGENCE:
      return fmt::format("The fit had not converged after {} iterations.", kMaxIterations);
    default:
      return "No step lowers the sum of squares, or the law has no finite value there.";
  }
}

}  // namespace

FitReport solve(ceres::Problem& problem, double* parameters, const std::vector<std::string>& names,
                Residuals residuals) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.minimizer_progress_to_stdout = false;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kTolerance;
  options.gradient_tolerance = kTolerance;
  options.parameter_tolerance = kTolerance;
#ifdef TWINCELL_HAS_GLOG
  FLAGS_minloglevel = google::GLOG_FATAL;  // the report states what Ceres would print on stderr
#endif
  FitReport report;
  report.names = names;
  report.n_residuals = problem.NumResiduals();
  // A linear problem may start at its solution, where Ceres finds no improving step and reports a failure.
  if (slope_left(problem) <= kAtMinimum) {
    report.values.assign(parameters, parameters + names.size());
    problem.Evaluate(ceres::Problem::EvaluateOptions(), &report.cost_after, nullptr, nullptr, nullptr);
    report.cost_before = report.cost_after;
    report.stop_reason = "The start is the minimum: the residuals are orthogonal to every derivative.";
    report.usable = true;
    add_covariance(report, jacobian_at(problem), residuals);
    return report;
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  if (summary.IsSolutionUsable()) polish(problem, parameters, names.size());
  report.values.assign(parameters, parameters + names.size());
  report.cost_before = summary.initial_cost;
  problem.Evaluate(ceres::Problem::EvaluateOptions(), &report.cost_after, nullptr, nullptr, nullptr);
  report.stop_reason = why_stopped(summary);
  report.usable = summary.IsSolutionUsable();
  if (!report.usable) {
    report.why_not = report.stop_reason;
    return report;
  }
  add_covariance(report, jacobian_at(problem), residuals);
  return report;
}

}  // namespace twincell::calibration
