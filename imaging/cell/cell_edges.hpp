#pragma once
/// \file
/// Sub-pixel edges of side walls and plate in a frame.
///
/// Every row is searched from the left and from the right border, and every column from the bottom, through
/// the dark to the first bright pixel. A wall or plate that is a bar with light behind it is searched from
/// its outer side, if that is straight and not the rim of a bead. At the step there, at position e, the light
/// relative to the local light is
///     l_i = Phi((i - e)/s) - D_i,
/// with a blur s common to all rows of a frame (and another common to all columns), and D_i the share of
/// light that the beads block, from their fitted discs. Beads and walls do not overlap, so what they block
/// adds up, before and after the blur. Pixels with D_i > 0.03 are left out. The local light is a quadratic
/// surface through the pixels visible past the beads. Without a bead nearby the step is symmetric, and e does
/// not depend on s. There is no point within 4.5 s of a corner, or where no light reaches the step. A bead
/// that touches the wall and was not located hides the wall: the point is then on the bead's far side, always
/// further inside the cell, never outside.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// A point of an edge.
struct EdgePoint {
  PixelPoint at;
  double sigma = 0;  ///< standard deviation across the edge due to the camera's noise, px
};

/// Edges of the cell in one frame. Some points can be on beads.
struct CellEdges {
  std::vector<EdgePoint> left, right;  ///< at most one per row
  std::vector<EdgePoint> plate;        ///< at most one per column
  double blur_px = 0;  ///< standard deviation of the plate's blur, including the pixel width; 0: no edge
};

/// What is known of the beads, which hide the edges that they touch.
struct BeadsAtEdges {
  bool bright = false;           ///< beads, walls and plate are brighter than the background
  double diameter_px = 0;        ///< 3 .. 400
  std::string refine = "exact";  ///< method that suits the discs, one of refiner_names()
};

/// Finds the edges. A side has no points unless the picture is dark there up to its border, over at least
/// 3 px, or a dark bar of at least 4 px crosses at least a third of the lines. Pure.
CellEdges find_cell_edges(const cv::Mat& picture, const BeadsAtEdges& beads);

}  // namespace twincell::imaging
