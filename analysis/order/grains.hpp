#pragma once
/// \file
/// Grains (connected regions of one lattice direction) and the boundaries between them.

#include <vector>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kGrainTurn = 5;        ///< degrees; largest misorientation of neighbours in one grain
inline constexpr std::size_t kGrainBeads = 7;  ///< minimum number of beads: one bead and its six neighbours

/// The grains of one frame.
struct Grains {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> of_bead;  ///< [n_beads] grain of the bead, or kNone
  std::vector<std::size_t> beads;    ///< [grains] number of beads; descending
  std::vector<double> angle;         ///< [grains] lattice_angle of the sum of its beads' psi_6, degrees
};

/// Finds the grains. Neighbours (beads whose Voronoi cells share an edge) belong to one grain if both have
/// psi6 > kOrdered and their lattice directions differ by at most kGrainTurn. Groups of fewer than
/// kGrainBeads beads are not grains. The remaining beads then join, layer by layer, the grain
/// with which they share the greatest total edge length. Grains then touch, and a boundary is a line without
/// a disordered layer between the grains.
Grains find_grains(const BondOrder& order, const VoronoiCells& cells);

/// Grains of the packing. Results:
///
/// - grains: scalar, number of grains, mean over frames
/// - largest_grain: scalar, share of the beads in the largest grain, mean over frames
/// - grain_boundary_fraction: scalar, share of the beads with a neighbour in another grain, mean over frames
/// - grain_boundary_angle: scalar, misorientation of two grains at their boundary, degrees, mean over pairs
///   of neighbours and over frames
/// - grain_beads: [n_beads] grain of each bead in the last frame: 0 the largest grain, NaN without grain
///
/// Bond order uses the neighbour rule of the analysis, adjacency always uses Voronoi neighbours. Absent in a
/// cell that is not planar. Fortini & Huang 2015, sec. III.
extern const ObservableEntry grains_observable;

}  // namespace twincell::analysis
