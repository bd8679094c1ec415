#pragma once
/// \file
/// Interpolation in a collocation step (collocation.hpp): polynomials through the start and the eight stages,
/// evaluated anywhere in the step with the barycentric formula (J.-P. Berrut, L. N. Trefethen, SIAM Review
/// 46, 501 (2004), eq. 4.2), and their derivatives (C. Schneider, W. Werner, Mathematics of Computation 47,
/// 285 (1986)).

#include "sim/contact/collocation.hpp"

namespace twincell::sim {

/// Scalar product of two arrays of eight numbers, summed in pairs to shorten the dependency chain.
[[gnu::always_inline]] inline double sum_of_products(const double* a, const double* b) {
  double c[kStages];
  for (std::size_t k = 0; k < kStages; ++k) c[k] = a[k] * b[k];
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

/// Evaluates interpolation polynomials at a fraction x of the step.
class StagePolynomials {
 public:
  [[gnu::always_inline]] explicit StagePolynomials(const Collocation& numbers, double x) {
    const auto apart = [&](std::size_t place) {
      const double d = x - numbers.place[place];
      return d == 0 ? 1e-100 : d;
    };
    for (std::size_t k = 0; k < kStages; ++k) per_[k] = 1 / apart(k + 1);
    for (std::size_t k = 0; k < kStages; ++k) share_[k] = numbers.weight[k + 1] * per_[k];
    per_start_ = 1 / apart(0);
    const double start = numbers.weight[0] * per_start_, whole = 1 / (start + sum_of_products(share_, kOnes));
    for (double& share : share_) share *= whole;
    start_ = start * whole;
  }
  /// Value of the polynomial that equals `begins` at the start and `values` at the stages.
  [[nodiscard]] [[gnu::always_inline]] double value(double begins, const double* values) const {
    return start_ * begins + sum_of_products(share_, values);
  }
  /// Derivative with respect to x of that polynomial, given its value at x.
  [[nodiscard]] [[gnu::always_inline]] double slope(double begins, const double* values, double value) const {
    double apart[kStages];
    for (std::size_t k = 0; k < kStages; ++k) apart[k] = per_[k] * (value - values[k]);
    return start_ * per_start_ * (value - begins) + sum_of_products(share_, apart);
  }

 private:
  static constexpr double kOnes[kStages] = {1, 1, 1, 1, 1, 1, 1, 1};
  double share_[kStages], per_[kStages], start_, per_start_;
};

}  // namespace twincell::sim
