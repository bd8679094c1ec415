#pragma once
/// \file
/// Threshold of the outliers of a robust fit.

namespace twincell::calibration {

/// Larger residuals are outliers; in robust standard deviations (robust_spread of median.hpp).
inline constexpr double kWorstSigma = 4;

}  // namespace twincell::calibration
