#pragma once
/// \file
/// Figure of the edge residuals.

#include "analysis/report/figure.hpp"
#include "calibration/camera/cell_geometry.hpp"

namespace twincell::calibration {

/// "edges": map of the residuals in px over the picture, at most 8000 points.
analysis::Figure edge_map_figure(const CellGeometry& geometry);

}  // namespace twincell::calibration
