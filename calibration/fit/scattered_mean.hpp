#pragma once
/// \file
/// Mean of values that scatter by more than their errors. The variance s^2 that brings chi^2 to its
/// expectation is added to the variance of each value (Paule & Mandel 1982). A common factor on the errors,
/// which was tried, keeps the weights of the errors, under which one value may count for all.

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace twincell::calibration {

/// A weighted mean with its standard error, and the chi^2 of the values about it.
struct WeightedMean {
  double mean, error, chi2;
};

/// Best linear unbiased mean of correlated values.
WeightedMean weighted_mean(const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance);
/// Mean of independent values, `scatter` added to the variance of each.
/// \param variances of each value
WeightedMean weighted_mean(const std::vector<double>& values, const std::vector<double>& variances,
                           double scatter);

/// The bisection for s^2.
struct ScatterSearch {
  double low, high;   ///< the interval that contains s^2
  int halvings;       ///< number of bisections
  bool of_logarithm;  ///< bisect ln s^2, for an interval of several decades; low > 0
};

/// The result of the bisection. The two values differ by at most the width of the last interval; callers use
/// one or the other.
struct FoundScatter {
  double last;   ///< last midpoint
  double upper;  ///< upper end of the last interval: chi^2 is at most its expectation
};

/// Finds the s^2 at which chi^2 equals `freedom`.
/// \param chi2 as a function of s^2, descending
FoundScatter find_scatter(const std::function<double(double)>& chi2, double freedom,
                          const ScatterSearch& search);

}  // namespace twincell::calibration
