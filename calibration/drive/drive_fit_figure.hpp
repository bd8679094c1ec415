#pragma once
/// \file
/// Figure of the plate's heights folded onto one cycle, with the fit and its residuals.

#include "analysis/report/figure.hpp"
#include "calibration/drive/drive_fit.hpp"

namespace twincell::calibration {

/// "plate": heights and fit above, residuals below, against the phase of the drive.
analysis::Figure drive_fit_figure(const DriveFit& lock);

}  // namespace twincell::calibration
