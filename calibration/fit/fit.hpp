#pragma once
/// \file
/// Least-squares solution by Ceres, with errors, condition number and undetermined parameters.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ceres {
class Problem;
}

namespace twincell::calibration {

/// Result of a fit and its reliability.
struct FitReport {
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<double> standard_errors;  ///< empty if there is no covariance
  Eigen::MatrixXd covariance;  ///< of the values; empty if not identifiable or no degree of freedom is left
  int n_residuals = 0;
  double cost_before = 0;  ///< (1/2) sum of squared residuals at the start
  double cost_after = 0;   ///< the same at the solution
  /// Condition number of the scaled normal matrix. If it is large, the data do not separate the parameters.
  double condition = 0;
  std::vector<std::string> undetermined;  ///< parameters that the data do not determine
  std::string stop_reason;
  bool usable = false;
  std::string why_not;  ///< reason if the fit is not usable, or usable but without errors

  /// Root mean square residual, sqrt(2 cost_after/n_residuals).
  [[nodiscard]] double rms() const;
  /// Value of the parameter called `name`.
  /// \pre `names` contains it
  [[nodiscard]] double value(const std::string& name) const;
  /// Its standard error; NaN without errors.
  /// \pre `names` contains it
  [[nodiscard]] double standard_error(const std::string& name) const;
};

/// Whether residuals are in units of their standard deviation.
enum class Residuals {
  weighted,    ///< yes: the covariance is (J^T J)^-1
  unweighted,  ///< no: it is s^2 (J^T J)^-1 with s^2 = sum r^2/(n_residuals - n_parameters)
};

/// Solves `problem`, whose only parameter block is `parameters` (one per name), to machine precision
/// (tolerances 1e-15). If the condition number of the scaled normal matrix exceeds 1e12, the problem is not
/// identifiable: the report has no errors and names the parameters that contribute to the undetermined
/// directions.
FitReport solve(ceres::Problem& problem, double* parameters, const std::vector<std::string>& names,
                Residuals residuals = Residuals::unweighted);

}  // namespace twincell::calibration
