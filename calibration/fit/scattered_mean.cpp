#include "calibration/fit/scattered_mean.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>

namespace twincell::calibration {

WeightedMean weighted_mean(const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(values.size());
  const auto factored = covariance.ldlt();
  const Eigen::VectorXd w = factored.solve(one);
  const double mean = w.dot(values) / w.dot(one);
  const Eigen::VectorXd left = values - mean * one;
  return {mean, 1 / std::sqrt(w.dot(one)), left.dot(factored.solve(left))};
}

WeightedMean weighted_mean(const std::vector<double>& values, const std::vector<double>& variances,
                           double scatter) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double w = 1 / (scatter + variances[i]);
    sum += w * values[i];
    weight += w;
  }
  const double mean = sum / weight;
  double chi2 = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    chi2 += std::pow(values[i] - mean, 2) / (scatter + variances[i]);
  return {mean, 1 / std::sqrt(weight), chi2};
}

FoundScatter find_scatter(const std::function<double(double)>& chi2, double freedom,
                          const ScatterSearch& search) {
  double low = search.low, high = search.high, middle = low;
  for (int i = 0; i < search.halvings; ++i) {
    middle = search.of_logarithm ? std::sqrt(low * high) : (low + high) / 2;
    (chi2(middle) > freedom ? low : high) = middle;
  }
  return {middle, high};
}

}  // namespace twincell::calibration
