#pragma once
/// \file
/// Which edge points belong to a wall or to the plate. Points on beads and other outliers are always inside
/// the cell, so an edge is the outermost line that enough points share.

#include <cstddef>
#include <optional>
#include <vector>

#include "imaging/cell/cell_edges.hpp"
#include "imaging/geometry/pixel_point.hpp"

namespace twincell::calibration {

/// Width of the window in which points belong to one edge.
inline constexpr double kEdgeWindow_px = 0.6;

/// Position of a wall in one picture row, averaged over `frames` frames.
struct WallRow {
  imaging::PixelPoint at;
  double frames = 1;
  std::vector<std::size_t> seen = {};  ///< these frames; beads and plate hide a row at some phases
  double floor = 0;                    ///< mean row of the plate in these frames, ideal picture
};

/// One point per picture row of a wall: the mean over the frames of the points on the wall. Rows that are
/// detected in less than a quarter of the frames are left out; empty if 5 % of the points share no line.
/// \param frames the edge points of each frame
/// \param side 0: left wall, 1: right wall
std::vector<WallRow> rows_of_wall(const std::vector<std::vector<imaging::EdgePoint>>& frames, int side);

/// Slope of the plate's edge, px upwards per px to the right: the median over frames. A row of beads above a
/// visible plate is never the outermost line. Absent if the plate is not seen.
/// \param plate the edge points of each frame
/// \param stride of every so many frames one is used
std::optional<double> plate_slope(const std::vector<std::vector<imaging::EdgePoint>>& plate,
                                  std::size_t stride);

/// Points of the plate's edge in one frame: those within `window` of the outermost line with the given slope,
/// px; none if no such line contains 3 % of the points.
std::vector<imaging::PixelPoint> on_plate(const std::vector<imaging::EdgePoint>& frame, double slope,
                                          double window);

}  // namespace twincell::calibration
