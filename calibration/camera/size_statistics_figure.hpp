#pragma once
/// \file
/// Figure of the distribution of bead diameters.

#include "analysis/report/figure.hpp"
#include "calibration/camera/size_statistics.hpp"

namespace twincell::calibration {

/// "beads": histogram of the diameters.
/// \param unit_px pixels per length unit of `census`; NaN: the axis is in the unit of `census`, sigma
analysis::Figure size_statistics_figure(const SizeStatistics& census, double unit_px);

}  // namespace twincell::calibration
