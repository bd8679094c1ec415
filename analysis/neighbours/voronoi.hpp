#pragma once
/// \file
/// Voronoi cells of limited radius and their shared edges.

#include <cstdint>
#include <vector>

#include "analysis/neighbours/neighbours.hpp"

namespace twincell::analysis {

/// Two beads are neighbours only if their shared edge is longer than this, sigma. In a square lattice four
/// cells meet in a point, and rounding may stretch that point into a short edge; such an edge must not create
/// neighbours.
inline constexpr double kShortestEdge = 1e-6;

/// Default radius of a cell, sigma. The cells close a gap between five touching beads (circumradius 0.851)
/// but leave open the hole between six touching beads around a missing bead (circumradius 1.000).
inline constexpr double kCellRadius = 0.9;

/// The Voronoi cells of one planar frame.
struct VoronoiCells {
  Neighbours neighbours;     ///< beads whose cells share an edge
  std::vector<double> edge;  ///< [entries of neighbours] length of that edge, sigma
  /// [entries of neighbours] 1 if the edge's end on the left of the bond is on the rim of the cell and not at
  /// the cell of a third bead: a hole or the outside is to the left of this bond.
  std::vector<std::uint8_t> open_left;
  std::vector<std::uint8_t> enclosed;  ///< [n_beads] 1 if no part of the rim remains: not a surface bead
};

/// Computes the Voronoi cells of one frame. The cell of a bead is the region of the plane that is nearer to
/// it than to any other bead and at most `radius` away from it. Two beads are neighbours if their cells share
/// an edge longer than kShortestEdge. Where every circle of that radius contains a bead, the neighbour graph
/// is the Delaunay triangulation; across free surfaces, along walls and across holes it lacks the long edges
/// of that triangulation. (The graph is that of the alpha complex, Edelsbrunner, Kirkpatrick & Seidel 1983.)
///
/// A cell depends only on beads within 2 radius. The beads near a bond clip its bisector to the shared edge.
/// No triangulation is stored, so that rounding cannot corrupt one, co-circular beads are not a special case,
/// and the result does not depend on the order of beads. Bead sizes are not used. The y coordinate is used
/// only to find the beads within 2 radius. Cost O(N log N).
/// \pre radius > 0; a periodic box is wider than 4 radius
VoronoiCells voronoi_cells(const Frame& frame, const Box& box, double radius = kCellRadius);

}  // namespace twincell::analysis
