#pragma once
/// \file
/// Which residuals of a robust fit are outliers.

namespace twincell::calibration {

/// Residuals beyond it, in robust standard deviations, are outliers.
inline constexpr double kWorstSigma = 4;

}  // namespace twincell::calibration
