#pragma once
/// \file
/// Whether residuals are larger than the stated errors.

#include <cmath>

namespace twincell::calibration {

/// Whether chi^2, the sum of squared residuals over squared errors, is beyond what errors explain: more than
/// three standard deviations of its distribution above its mean, plus 4, so that few degrees of freedom raise
/// no alarm.
/// \param freedom number of data less number of parameters, 0 or more
inline bool is_beyond_errors(double chi2, double freedom) {
  return chi2 > freedom + 3 * std::sqrt(2 * freedom) + 4;
}

}  // namespace twincell::calibration
