#pragma once
/// \file
/// Least squares by Ceres, with an honest account of what came out.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ceres {
class Problem;
}

namespace twincell {

/// What a fit found and how far it can be trusted.
struct FitReport {
  std::vector<std::string> names;
  std::vector<double> values;
  std::vector<double> standard_errors;  ///< empty if there is no covariance
  Eigen::MatrixXd covariance;  ///< of the values; empty if not identifiable or no degree of freedom is left
  int n_residuals = 0;
  double cost_before = 0;  ///< (1/2) sum of squared residuals at the start
  double cost_after = 0;   ///< and at the end
  double condition =
      0;  ///< condition number of the scaled normal matrix; large: the data do not tell parameters apart
  std::vector<std::string> undetermined;  ///< parameters that the data leave open; empty if none is
  std::string stop_reason;
  bool usable = false;
  std::string why_not;  ///< if not usable, or usable without errors: the reason

  /// Root mean square residual, sqrt(2 cost_after/n_residuals).
  [[nodiscard]] double rms() const;
  /// Value of the parameter called `name`. \pre it is there
  [[nodiscard]] double value(const std::string& name) const;
  [[nodiscard]] double standard_error(const std::string& name) const;
};

/// Are residuals in units of their own standard deviation?
enum class Residuals {
  weighted,    ///< yes: the covariance is (J^T J)^-1
  unweighted,  ///< no: it is s^2 (J^T J)^-1 with s^2 = sum r^2/(n_residuals - n_parameters)
};

/// Solves `problem`, whose only parameter block is `parameters` (one per name), to the last digits
/// (tolerances 1e-15). A fit whose scaled normal matrix has a condition number above 1e12 is reported without
/// errors: not identifiable; the parameters that have a share in what the data leave open are named.
FitReport solve(ceres::Problem& problem, double* parameters, const std::vector<std::string>& names,
                Residuals residuals = Residuals::unweighted);

}  // namespace twincell
