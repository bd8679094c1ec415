#pragma once
/// \file
/// Defects of the hexagonal lattice: disclinations, dislocations, holes.

#include <memory>
#include <vector>

#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell {

/// The defects of one frame. Only enclosed beads (VoronoiCells) count: at a wall or a free surface a bead has
/// fewer neighbours without being a defect.
struct Defects {
  std::vector<std::size_t> coordination;  ///< [n_beads] number of neighbours; 0 for a bead at a surface
  std::size_t bulk = 0;                   ///< enclosed beads
  std::size_t five = 0, seven = 0;        ///< disclinations of charge +1 and -1
  std::size_t other = 0;                  ///< neither 5, 6 nor 7 neighbours
  std::size_t dislocations = 0;  ///< pairs of neighbours, one 5- and one 7-fold, no bead in two pairs
  std::size_t holes = 0;         ///< closed loops of surface beads inside the packing
};

/// Coordination by Voronoi neighbours. Dislocations are as many as can be paired at once (maximum matching),
/// so that the number does not depend on the order in which pairs are looked for; a disclination without a
/// partner is free. A hole is a face of the neighbour graph that no circle of the cell's radius covers: a
/// missing bead of a perfect crystal leaves one, and its six neighbours are then surface, not disclinations.
Defects find_defects(const VoronoiCells& cells);

/// Results disclinations_5, disclinations_7, disclinations_other, dislocations, free_disclinations, holes
/// (mean numbers per frame), defect_fraction (share of enclosed beads that have not 6 neighbours),
/// defect_fraction_j (the same at the beginning of every cycle), coordination_beads (last frame). Fortini &
/// Huang 2015, sec. III, "topological defects"; the Delaunay definition is Nelson & Halperin 1979's.
std::unique_ptr<Observable> make_defects(const AnalysisContext& context);

}  // namespace twincell
