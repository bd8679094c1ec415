#pragma once
/// \file
/// Defects of the hexagonal lattice: disclinations, dislocations, holes.

#include <vector>

#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// The defects of one frame. Only enclosed beads (VoronoiCells) are counted: at a wall or a free surface a
/// bead has fewer neighbours without being a defect.
struct Defects {
  std::vector<std::size_t> coordination;  ///< [n_beads] number of neighbours; 0 for a bead at a surface
  std::size_t bulk = 0;                   ///< enclosed beads
  std::size_t five = 0, seven = 0;        ///< disclinations of charge +1 and -1
  std::size_t other = 0;                  ///< neither 5, 6 nor 7 neighbours
  std::size_t dislocations = 0;  ///< pairs of neighbours, one 5- and one 7-fold, no bead in two pairs
  std::size_t holes = 0;         ///< closed loops of surface beads inside the packing
};

/// Finds the defects from the numbers of Voronoi neighbours. The number of dislocations is the maximum
/// number of simultaneous pairs (maximum matching), so that it does not depend on the order of the search. A
/// disclination without a partner is free. A hole is a face of the neighbour graph that no circle of the
/// cell's radius covers. A missing bead of a perfect crystal leaves a hole; its six neighbours are then
/// surface beads, not disclinations.
Defects find_defects(const VoronoiCells& cells);

/// Defects of the hexagonal lattice. Results:
///
/// - disclinations_5, disclinations_7: scalars, mean number per frame of enclosed beads with 5, 7 neighbours
/// - disclinations_other: scalar, mean number of enclosed beads with fewer than 5 or more than 7 neighbours
/// - dislocations: scalar, mean number per frame
/// - free_disclinations: scalar, mean number per frame of 5- and 7-fold beads that are not in a dislocation
/// - holes: scalar, mean number per frame
/// - defect_fraction: scalar, share of the enclosed beads that do not have 6 neighbours, mean over frames
/// - defect_fraction_j: [cycles] the same at the beginning of each cycle ([frames] without phases)
/// - coordination_beads: [n_beads] number of neighbours in the last frame, NaN for surface beads
///
/// Absent in a cell that is not planar. Fortini & Huang 2015, sec. III, "topological defects"; the definition
/// by the Delaunay triangulation follows Nelson & Halperin 1979.
extern const ObservableEntry defects_observable;

}  // namespace twincell::analysis
