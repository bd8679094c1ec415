#pragma once
/// \file
/// Voronoi cells of limited size, and who shares an edge with whom.

#include <cstdint>
#include <vector>

#include "analysis/neighbours/neighbours.hpp"

namespace twincell {

/// Shared edges shorter than this make no neighbours, sigma. In a square lattice four cells meet in a point;
/// whether rounding stretches that point into an edge shall not decide who is a neighbour.
inline constexpr double kShortestEdge = 1e-6;

/// Default size of a cell, sigma: a hole between five touching beads (circumradius 0.851) is closed, one
/// between six, which a missing bead leaves (1.000), is not.
inline constexpr double kCellRadius = 0.9;

/// The Voronoi cells of one planar frame.
struct VoronoiCells {
  Neighbours neighbours;     ///< beads whose cells share an edge
  std::vector<double> edge;  ///< [entries of neighbours] length of that edge, sigma
  /// [entries of neighbours] 1 where the edge's end on the left of the bond lies on the rim of the cell and
  /// not at a third bead's cell: to the left of this bond there is a hole or the outside.
  std::vector<std::uint8_t> open_left;
  std::vector<std::uint8_t> enclosed;  ///< [n_beads] 1 if no part of the rim is left: the bead is no surface
};

/// The cell of a bead is the part of the plane nearer to it than to any other bead and no farther from it
/// than `radius`. Two beads are neighbours if their cells share an edge longer than kShortestEdge. Where no
/// circle of that radius is empty of beads this is the Delaunay triangulation; across free surfaces, along
/// walls and across holes it has none of that triangulation's long edges. (The graph is that of the alpha
/// complex, Edelsbrunner, Kirkpatrick & Seidel 1983.)
///
/// A cell depends on beads within 2 radius alone, so that each edge is cut out of its bisector by the beads
/// near it: no triangulation is kept that rounding could spoil, co-circular beads are no special case, and
/// the result does not depend on the order of beads. Sizes of beads are not used. The y coordinate is not
/// used beyond finding who is near. Cost O(N log N). \pre radius > 0; a periodic cell is wider than 4 radius
VoronoiCells voronoi_cells(const Frame& frame, const Box& box, double radius = kCellRadius);

}  // namespace twincell
