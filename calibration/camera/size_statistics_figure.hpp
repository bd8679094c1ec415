#pragma once
/// \file
/// How the diameters of the beads are spread.

#include "analysis/report/figures.hpp"
#include "calibration/camera/size_statistics.hpp"

namespace twincell {

/// "beads": histogram of the diameters. \param unit_px pixels in the census' unit; NaN: drawn in its unit,
/// sigma
Figure size_statistics_figure(const SizeStatistics& census, double unit_px);

}  // namespace twincell
