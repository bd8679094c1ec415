#pragma once
/// \file
/// Slip: beads that move relative to their neighbours from one cycle to the next, and the direction.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// A bond has slipped if its vector changed by more than this within one period, sigma.
inline constexpr double kSlipDistance = 0.2;
/// A bead has slipped if at least this many of its bonds have slipped. One step of a dislocation along a
/// close-packed row changes two bonds of every bead next to the row.
inline constexpr std::size_t kSlipBonds = 2;
/// Beads closer than this to the free surface do not count, sigma.
inline constexpr double kSlipDepth = 10;
/// A bead belongs to the bed, not to the beads thrown above it, if it has this many neighbours: a bead in the
/// top layer of a crystal has four.
inline constexpr std::size_t kSurfaceNeighbours = 4;

/// Slip between the beginnings of consecutive cycles (Fortini & Huang 2015, sec. V). Results:
///
/// - p_s: scalar, slip probability: mean over periods of the ratio of slipping to eligible beads. The 95 %
///   interval is binomial. If the fraction scatters more from period to period than for independent beads,
///   the counts are divided by the ratio of the variances and the interval is Wilson's. Without any slip, the
///   interval is the one-sided upper limit
/// - slips: scalar, number of slips; `n` is the number of trials (bead-periods)
/// - p_s_j: [periods] fraction of slipping beads in each period; it starts high and falls in an annealing bed
/// - slip_directions: [36] number of bonds of slipping beads by the direction in which they moved, in bins of
///   5 degrees centred at 0 (horizontal), 5, … 90 (vertical), … 175
/// - slip_oblique, slip_vertical, slip_horizontal: scalars, share of those bonds within 15 degrees of +-60,
///   90 and 0 degrees. Orientation A slips obliquely, B vertically; without a preferred direction the shares
///   are 1/3, 1/6, 1/6. The 95 % interval is by bootstrap over the periods with slips
///
/// A bead slips if at least two of its neighbours move relative to it by more than 0.2 sigma. The criterion
/// uses the change of the bond vector, so that a slip by a whole lattice constant counts and a translation of
/// the bed does not. A rigid rotation by more than 0.2 rad within a period would also count. The neighbours
/// are those of the analysis's neighbour rule at the start of the period. A bead is eligible if it is at
/// least 10 sigma below the free surface (median over columns 2 sigma wide of the highest bead with four
/// neighbours, at the start of the period) and is seen at both ends of the period with at least two
/// neighbours. If no bead is eligible (thin beds), the results are absent, not zero, and state the reason.
extern const ObservableEntry slip_observable;

}  // namespace twincell::analysis
