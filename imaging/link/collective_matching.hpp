#pragma once
/// \file
/// Collective matching: assigns the beads of one frame to the detections of the next, all at once, when
/// neighbours move nearly alike.
///
/// A block of a crystal looks the same after a shift by a lattice vector. The fit of each single bead to a
/// detection therefore does not show where the block moved. But if a block is shifted by a wrong lattice
/// vector, neighbours separate at its rim, one bead too many claims the same position, and other positions
/// remain unused. All beads are therefore matched together. The matching minimises the sum of
///
/// - u_t(k) for bead t assigned to detection k, 0 for an unassigned bead;
/// - 2 ln(1 + r^2 / w^2) for neighbours whose steps differ by r, with w = 0.15 d, capped at its value at r =
///   1.2 d. The cap is also paid if either of the two is unassigned. The weight is lower for neighbours that
///   do not touch;
/// - up to 15 for beads within 3 d of each other whose straight paths would take one disc through the other:
///   0 if the centres stay at least 0.9 d apart, the full cost at 0.75 d. (Of 0.57 million pairs in a
///   simulated convecting cell at 20 frames per cycle, one came closer than 0.9 d, none closer than 0.85 d.)
/// - 8 for an unused detection, 2 where beads come into sight.
///
/// The sum is a negative log-odds. It is minimised in three steps. First, messages are exchanged between
/// neighbours (min-sum belief propagation: Pearl, Probabilistic Reasoning in Intelligent Systems, 1988) and
/// between rivals for a detection (Bayati, Shah & Sharma, IEEE Trans. Inf. Theory 54, 1241 (2008)). This runs
/// twice: plainly, and tempered as in tree-reweighted message passing (Kolmogorov, IEEE Trans. PAMI 28, 1568
/// (2006)). Second, proposals are grown outwards from one bead; each bead follows the steps of its
/// neighbours. Two answers are merged by a minimum cut, which takes the better one region by region (fusion
/// moves: Lempitsky, Rother, Roth & Blake, IEEE Trans. PAMI 32, 1392 (2010)). Third, up to four beads
/// exchange detections along a closed or open chain; at most a thousand chains are tried from each bead. None
/// of the steps is sufficient alone in a convecting bed, and the result is not proved to be the global
/// minimum.
///
/// In a closed cell an unused detection finally costs 300. There a column of beads may slide along a wall by
/// one lattice vector within a frame, and except for the beads at its ends all of it looks cheaper at rest.
/// From each unassigned bead a label-correcting shortest-path search finds the cheapest chain in which each
/// bead takes the position of the next and the last bead takes an unused detection.

#include <cstdint>
#include <span>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"
#include "imaging/link/assignment.hpp"

namespace twincell::imaging {

/// The cheapest matching found.
struct CollectiveMatching {
  std::vector<std::int64_t> column_of_row;  ///< detection of each bead; Assignment::kAlone: unassigned
  /// Smallest rise of the sum if the bead takes another detection, exchanging detections with the bead there
  /// while all others stay. This is the cost of an error in one or two beads, not in a block. Infinity if the
  /// rise is known to exceed 10. 0 where two searches disagree, or where the bead is assigned only because
  /// the cell is closed.
  std::vector<double> margin;
};

/// Prior knowledge about the frame.
struct MatchKnowledge {
  std::span<const std::int32_t> initial;  ///< detection of each bead in a starting solution, < 0: unassigned
  bool all_present = false;               ///< each bead is at one of the detections
  /// 1 for a detection that may be a bead not seen before; empty: no such detection.
  std::span<const std::uint8_t> newcomers;
};

/// Matches all beads at once.
/// \param places positions of the beads in the previous frame
/// \param detections positions detected in this frame
/// \param choices row: bead, column: detection, cost: u_t(k); sorted by row; a row and a column share at most
///     one edge
/// \param diameter_px bead diameter d, > 0
CollectiveMatching match_collectively(std::span<const PixelPoint> places,
                                      std::span<const PixelPoint> detections, std::span<const Edge> choices,
                                      double diameter_px, const MatchKnowledge& known = {});

}  // namespace twincell::imaging
