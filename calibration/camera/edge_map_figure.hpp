#pragma once
/// \file
/// Where the edges lie away from the fitted lines.

#include "analysis/report/figures.hpp"
#include "calibration/camera/cell_geometry.hpp"

namespace twincell {

/// "edges": the map of residuals over the picture above, their size along each edge below.
Figure edge_map_figure(const CellGeometry& geometry);

}  // namespace twincell
