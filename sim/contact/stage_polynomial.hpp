#pragma once
/// \file
/// Polynomials through the start of a step of collocation.hpp and its eight moments, anywhere in between: the
/// barycentric formula (J.-P. Berrut, L. N. Trefethen, SIAM Review 46, 501 (2004), eq. 4.2), and its
/// derivative (C. Schneider, W. Werner, Mathematics of Computation 47, 285 (1986)).

#include "sim/contact/collocation.hpp"

namespace twincell::sim {

/// Of eight each; in pairs: short chains.
[[gnu::always_inline]] inline double sum_of_products(const double* a, const double* b) {
  double c[kMoments];
  for (std::size_t k = 0; k < kMoments; ++k) c[k] = a[k] * b[k];
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

/// All of them at a fraction x of the step.
class StagePolynomials {
 public:
  [[gnu::always_inline]] explicit StagePolynomials(const Collocation& numbers, double x) {
    const auto apart = [&](std::size_t place) {
      const double d = x - numbers.place[place];
      return d == 0 ? 1e-100 : d;
    };
    for (std::size_t k = 0; k < kMoments; ++k) per_[k] = 1 / apart(k + 1);
    for (std::size_t k = 0; k < kMoments; ++k) share_[k] = numbers.weight[k + 1] * per_[k];
    per_start_ = 1 / apart(0);
    const double start = numbers.weight[0] * per_start_, whole = 1 / (start + sum_of_products(share_, kOnes));
    for (double& share : share_) share *= whole;
    start_ = start * whole;
  }
  /// The value of the one that begins so and has these values at the moments.
  [[nodiscard]] [[gnu::always_inline]] double value(double begins, const double* values) const {
    return start_ * begins + sum_of_products(share_, values);
  }
  /// Its slope, where its value is known.
  [[nodiscard]] [[gnu::always_inline]] double slope(double begins, const double* values, double value) const {
    double apart[kMoments];
    for (std::size_t k = 0; k < kMoments; ++k) apart[k] = per_[k] * (value - values[k]);
    return start_ * per_start_ * (value - begins) + sum_of_products(share_, apart);
  }

 private:
  static constexpr double kOnes[kMoments] = {1, 1, 1, 1, 1, 1, 1, 1};
  double share_[kMoments], per_[kMoments], start_, per_start_;
};

}  // namespace twincell::sim
