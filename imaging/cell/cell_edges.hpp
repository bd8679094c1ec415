#pragma once
/// \file
/// Edges of side walls and plate in a frame, to sub-pixel.
///
/// Every row is followed from the left and from the right border, every column from the bottom, through the
/// dark to the first light. On the step there, at e, light in shares of the local light is
///     l_i = T_i Phi((i - e)/s),
/// with the blur s that all rows (and all columns) of a frame share and T_i the light that the beads let
/// pass, by their own fitted discs; pixels with T_i < 0.97 are left out. The local light is a quadratic
/// surface through what is seen past the beads. Without a bead near it the step is symmetric, and e does not
/// depend on s. Within 4.5 s of a corner there is no point, nor where no light reaches the step. A bead that
/// touches the wall and was not located hides it: the point then lies on the bead's far side, always further
/// inside the cell, never outside.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell {

/// A point of an edge.
struct EdgePoint {
  PixelPoint at;
  double sigma = 0;  ///< standard deviation across the edge from the camera's noise, px
};

/// What one frame shows of the cell's limits. Points on beads are among them.
struct CellEdges {
  std::vector<EdgePoint> left, right;  ///< one a row at most
  std::vector<EdgePoint> plate;        ///< one a column at most
  double blur_px = 0;  ///< standard deviation of the plate's blur, the pixels' own width in it; 0: no edge
};

/// Pure. A side without a dark border of at least 3 px has no points.
/// \param bright beads, walls and plate are brighter than what lies behind them \param diameter_px of a bead
CellEdges find_cell_edges(const cv::Mat& grey, bool bright, double diameter_px);

}  // namespace twincell
