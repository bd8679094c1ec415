#pragma once
/// \file
/// How the lattice lies in the cell: orientation A, B, or between.

#include <memory>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// A bead is ordered if its psi6 is larger (Fortini & Huang 2015, Fig. 1: "hexagonally ordered").
inline constexpr double kOrdered = 0.9;
/// A bead has orientation A or B if its lattice_angle is no farther than this from 0 or 30 degrees. Of
/// lattices lying anyhow a third is A, a third B, a third neither.
inline constexpr double kOrientationWidth = 10;

/// Results ordered_fraction (share of enclosed beads with psi6 > kOrdered), orientation (lattice_angle of the
/// sum of the ordered beads' psi_6 exp(i arg), degrees, mean over frames), orientation_a and orientation_b
/// (shares of the ordered beads), orientation_beads (lattice_angle of each bead in the last frame). Fortini &
/// Huang 2015, Fig. 2: A has close-packed rows along the floor (0 degrees), B along the side walls (30).
std::unique_ptr<Observable> make_orientation(const AnalysisContext& context);

}  // namespace twincell
