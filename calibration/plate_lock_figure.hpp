#pragma once
/// \file
/// The plate's heights folded on one cycle, with the fit and what it leaves.

#include "analysis/figures.hpp"
#include "calibration/plate_lock.hpp"

namespace twincell {

/// "plate": heights and fit above, residuals below, against the phase of the drive.
Figure plate_lock_figure(const PlateLock& lock);

}  // namespace twincell
