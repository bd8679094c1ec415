#pragma once
/// \file
/// How the diameters of the beads are spread.

#include "analysis/figures.hpp"
#include "calibration/bead_census.hpp"

namespace twincell {

/// "beads": histogram of the diameters. \param unit_px pixels in the census' unit; NaN: drawn in its unit,
/// sigma
Figure bead_census_figure(const BeadCensus& census, double unit_px);

}  // namespace twincell
