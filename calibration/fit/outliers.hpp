#pragma once
/// \file
/// Which residuals of a robust fit are outliers.

namespace twincell::calibration {

/// Residuals beyond it, in robust standard deviations, do not belong to what is fitted.
inline constexpr double kWorstSigma = 4;

}  // namespace twincell::calibration
