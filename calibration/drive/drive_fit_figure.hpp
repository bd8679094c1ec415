#pragma once
/// \file
/// The plate's heights folded on one cycle, with the fit and what it leaves.

#include "analysis/report/figures.hpp"
#include "calibration/drive/drive_fit.hpp"

namespace twincell {

/// "plate": heights and fit above, residuals below, against the phase of the drive.
Figure drive_fit_figure(const DriveFit& lock);

}  // namespace twincell
