#pragma once
/// \file
/// An autoregressive process fitted to a series: how much of a value its predecessors explain.

#include <vector>

namespace twincell::analysis {

/// The process
///
///     x_i - mean = sum_{k=1..p} a_k (x_{i-k} - mean) + e_i
///
/// with independent innovations e_i.
struct Autoregression {
  std::vector<double> coefficients;  ///< a_1 ... a_p, p >= 1
  std::vector<double> innovations;   ///< e_i for i = p ... n - 1, up to a constant
  /// Variance of the innovations over that of the series; 0 if each value follows from its predecessors.
  double unexplained = 1;
  /// Integrated correlation time 1/2 + sum_{k>=1} rho_k of the process, in steps; at least 1/2. Infinite if
  /// the fitted process is not stationary.
  double correlation_time = 0.5;

  /// 1 - sum a_k. The spectrum of the series at zero frequency is that of the innovations over its square.
  [[nodiscard]] double gain() const;
};

/// Fits the process by Burg's recursion (Burg 1975). The order p, from 1 to the smaller of 10 and n/8, is
/// that of the smallest Bayesian information criterion (Schwarz 1978). For p = 1, a_1 is the correlation of
/// successive values, corrected by (1 + 3 a_1)/n for the estimated mean (Kendall 1954), and not below 0, so
/// that an alternating series counts as independent.
/// \pre at least 2 values that are not all equal
Autoregression fit_autoregression(const std::vector<double>& series);

}  // namespace twincell::analysis
