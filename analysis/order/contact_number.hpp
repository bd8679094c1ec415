#pragma once
/// \file
/// Number of contacts of a bead, from positions.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Two beads touch if their centres are at most this factor times the sum of their radii apart. Positions
/// from images scatter by 0.03 sigma, and overlaps of simulated beads are smaller; the same distance on both
/// sides makes their numbers comparable.
inline constexpr double kContactReach = 1.05;

/// Contact number, also called geometric coordination number: mean number of beads that touch a bead,
///
///     Z = 2 pairs/beads,   pairs: |r_i - r_j| <= 1.05 (R_i + R_j)
///
/// in each frame, mean over frames. Walls do not count. 6 inside a triangular lattice, 4 inside a square one.
/// Results:
///
/// - contact_number: mean over all beads
/// - contact_number_inside: mean over beads with an enclosed Voronoi cell (voronoi.hpp), which excludes
///   surface beads; planar beds only
///
/// Intervals: those of correlated series over frames. C. Thornton, Geotechnique 50 (2000) 43.
extern const ObservableEntry contact_number_observable;

}  // namespace twincell::analysis
