#pragma once
/// \file
/// Grains: connected regions of one lattice direction, and the boundaries between them.

#include <memory>
#include <vector>

#include "analysis/neighbours/bond_order.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell {

inline constexpr double kGrainOrder = 0.9;     ///< least psi6 of a bead that makes a grain
inline constexpr double kGrainTurn = 5;        ///< degrees; largest misorientation of neighbours in one grain
inline constexpr std::size_t kGrainBeads = 7;  ///< least number of beads: one with its six neighbours

/// The grains of one frame.
struct Grains {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> of_bead;  ///< [n_beads] grain of the bead, kNone
  std::vector<std::size_t> beads;    ///< [grains] number of beads; descending
  std::vector<double> angle;         ///< [grains] lattice_angle of the sum of its beads' psi_6, degrees
};

/// Neighbours (beads whose Voronoi cells share an edge) belong to one grain if both have psi6 >= kGrainOrder
/// and their lattices differ by at most kGrainTurn; groups of fewer than kGrainBeads beads are none. With
/// `fill`, the beads in between then join the grain with which they share most of their cell's edges, layer
/// by layer, so that grains meet and a boundary is a line: its disorder has no width of its own.
Grains find_grains(const BondOrder& order, const VoronoiCells& cells, bool fill = true);

/// Results grains (number per frame), largest_grain (its share of the beads), grain_boundary_fraction (share
/// of the beads with a neighbour in another grain), grain_boundary_angle (misorientation of the two grains
/// there, degrees, mean over pairs of neighbours), grain_beads (grain of each bead in the last frame, 0 the
/// largest). Orientation by the neighbour rule of the analysis. Fortini & Huang 2015, sec. III.
std::unique_ptr<Observable> make_grains(const AnalysisContext& context);

}  // namespace twincell
