#pragma once
/// \file
/// Slip: beads that change neighbours' places between the beginnings of two cycles, and where to.

#include <memory>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// A bond has slipped if its vector changed by more than this within one period. sigma.
inline constexpr double kSlipDistance = 0.2;
/// A bead has slipped if at least this many of its bonds have: one step of a dislocation along a close-packed
/// row changes two bonds of every bead beside the row.
inline constexpr std::size_t kSlipBonds = 2;
/// Beads closer than this to the free surface do not count. sigma.
inline constexpr double kSlipDepth = 10;

/// Results (Fortini & Huang 2015, sec. V; all from the beginnings of consecutive cycles)
///   p_s              mean over periods of slipping/eligible beads; 95 % interval: binomial; where the
///   fraction
///                    scatters more from period to period than independent beads would, of counts divided by
///                    how much more (Wilson); for no slip at all the upper limit
///   slips            integer number of slips, of how many trials (bead-periods)
///   p_s_j            [periods] fraction of each period: an annealing bed starts high and falls
///   slip_directions  [36] how many bonds of slipping beads moved in which direction, bins of 5 degrees about
///   0
///                    (horizontal), 5, … 90 (vertical), … 175
///   slip_oblique, slip_vertical, slip_horizontal   share of those bonds within 15 degrees of +-60, 90, 0
///                    degrees (orientation A slips obliquely, B vertically; without a preferred direction
///                    1/3, 1/6, 1/6); 95 % interval by bootstrap over the periods with slips
/// A bead slips if at least two of its neighbours moved relative to it by more than 0.2 sigma: a vector
/// change, so that a slip by a whole lattice constant counts, and no translation of the bed does. A rigid
/// turn by more than 0.2 rad within a period would count too. Neighbours: by the rule of the analysis, at the
/// period's start. Eligible:
/// at least 10 sigma below the free surface (99th percentile of the centres' heights at the period's start),
/// and seen at both ends with at least two neighbours. Absent with the reason where no bead is eligible (thin
/// beds): not zero.
std::unique_ptr<Observable> make_slip(const AnalysisContext& context);

}  // namespace twincell
