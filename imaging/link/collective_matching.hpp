#pragma once
/// \file
/// Where each bead went, when neighbours move nearly alike.
///
/// A block of a crystal looks the same a lattice vector on, so how well each bead alone meets a detection
/// cannot tell where the block went. But at the rim of a block that is taken a lattice vector off, neighbours
/// part, one bead too many asks for the same place, and places are left over. So all beads are matched at
/// once, at the least sum of
///
/// - u_t(k) for bead t that goes to detection k, 0 for a bead that goes nowhere;
/// - 2 ln(1 + r^2 / w^2) for neighbours whose steps differ by r, w = 0.15 d, never more than at 1.2 d, which
///   is also paid where one of them goes nowhere; less for neighbours that do not touch;
/// - up to 15 for beads within 3 d of each other whose straight ways would take one disc through the other:
///   nothing down to 0.9 d between centres on the way, all at 0.75 d. (Of 0.57 million pairs in a simulated
///   cell that convects, 20 frames per cycle, one came nearer than 0.9 d, none nearer than 0.85 d.)
/// - 8 for a detection to which nobody goes, 2 where beads come into sight.
///
/// The sum is a negative logarithm of odds. Three steps make it small. Messages between neighbours (min-sum
/// belief propagation: Pearl, Probabilistic Reasoning in Intelligent Systems, 1988) and between rivals for a
/// detection (Bayati, Shah & Sharma, IEEE Trans. Inf. Theory 54, 1241 (2008)), twice: plainly, and tempered
/// as on trees (Kolmogorov, IEEE Trans. PAMI 28, 1568 (2006)). Then proposals grown from one bead outward,
/// each going where its neighbours lead. Two answers are joined by a least cut, region by region the better
/// (fusion moves: Lempitsky, Rother, Roth & Blake, IEEE Trans. PAMI 32, 1392 (2010)). At last up to
/// four beads change places in a ring or a row, at most a thousand such being tried from each. None of them
/// alone suffices in a bed that convects, and the sum is not proved to be the least.
///
/// Where nobody can be lost, a detection to which nobody goes costs 300 in the end: a column of beads may
/// slide along a wall by a lattice vector within a frame, and but for the beads at its ends, all of it looks
/// cheaper at rest. From each bead that goes nowhere the cheapest chain is sought in which each bead takes
/// the place of the next and the last one that nobody has (label-correcting shortest path).

#include <cstdint>
#include <span>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"
#include "imaging/link/assignment.hpp"

namespace twincell {

/// The cheapest match found.
struct CollectiveMatching {
  std::vector<std::int64_t> column_of_row;  ///< detection of each bead, Assignment::kAlone: none
  /// By how much the sum rises at least if the bead goes elsewhere, changing places with the bead there
  /// while all others stay: what it costs to be wrong about one bead or two, not about a block. Infinity:
  /// much. 0 where two ways to search disagree, or the bead goes there only because nobody can be lost.
  std::vector<double> margin;
};

/// What is known beforehand.
struct MatchKnowledge {
  std::span<const std::int32_t> guess;  ///< detection of each bead in an answer worth trying, < 0: none
  bool nobody_lost = false;             ///< each bead is known to be at one of the detections
  std::span<const std::uint8_t>
      newcomers;  ///< detections that may well be beads not seen before; empty: none
};

/// Matches all beads at once.
/// \param places where the beads were
/// \param detections where beads are
/// \param choices row: bead, column: detection, cost: u_t(k); sorted by row, a row and column meet at most
///     once
/// \param diameter_px bead diameter d, > 0
CollectiveMatching match_collectively(std::span<const PixelPoint> places,
                                      std::span<const PixelPoint> detections, std::span<const Edge> choices,
                                      double diameter_px, const MatchKnowledge& known = {});

}  // namespace twincell
