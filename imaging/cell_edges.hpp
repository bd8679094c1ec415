#pragma once
/// \file
/// Edges of side walls and plate in a frame, to sub-pixel.
///
/// Every row is followed from the left and from the right border, every column from the bottom, through the
/// dark to the first light. Where the dark before and the light behind that step both show their levels D and
/// L over some pixels, the edge lies where the step's own light says:
///     e = a - 1/2 + sum_{i = a}^{b} (d_i - L)/(D - L)
/// over pixels a .. b around the step (d: darkness). That is exact for any symmetric blur, motion blur
/// included, and takes no model of the edge. In narrow gaps, where full light lasts for a pixel or two, the
/// pixels on the step say it as those of a Gaussian's: d_i = Phi((e - i)/s) with the frame's own blur s.
/// Steps beside a bead, where no full light shows, give no point. A bead that touches the wall hides it: the
/// point then lies on the bead's far side, always further inside the cell, never outside.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/pixel_point.hpp"

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
  double blur_px = 0;  ///< standard deviation of the edges' blur, the pixels' own width in it; 0: no edge
};

/// Pure. A side without a dark border of at least 3 px has no points.
/// \param bright beads, walls and plate are brighter than what lies behind them \param diameter_px of a bead
CellEdges find_cell_edges(const cv::Mat& grey, bool bright, double diameter_px);

}  // namespace twincell
