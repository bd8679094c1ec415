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
/// Mean of independent values, `scatter` added to the variance of each. \param variances of each value
WeightedMean weighted_mean(const std::vector<double>& values, const std::vector<double>& variances,
                           double scatter);

/// How s^2 is searched: by halving [low, high], or, if the range covers decades, the logarithm of that range.
struct ScatterSearch {
  double low, high;
  int halvings;
  bool of_logarithm;
};

/// The end of a search for s^2. Callers differ in which end they use, and their results in the last bits.
struct FoundScatter {
  double tried;   ///< the value tried last, within a bracket of [low, high]
  double enough;  ///< the upper end of the bracket: chi^2 is at most its expectation
};

/// Finds the s^2 at which chi^2 equals `freedom`. \param chi2 as a function of s^2, descending
FoundScatter find_scatter(const std::function<double(double)>& chi2, double freedom,
                          const ScatterSearch& search);

}  // namespace twincell::calibration
