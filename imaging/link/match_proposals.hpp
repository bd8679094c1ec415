#pragma once
/// \file
/// Proposals of a collective matching, and the fusion of a proposal with the present matching
/// (collective_matching.hpp).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "imaging/link/match_problem.hpp"

namespace twincell::imaging {

/// The matching that the proposals improve.
struct PresentMatching {
  MatchSolution detection_of;          ///< of each bead; Assignment::kAlone: unassigned
  std::vector<std::int64_t> owner_of;  ///< bead of each detection; Assignment::kAlone: unused

  explicit PresentMatching(std::size_t detections) : owner_of(detections, Assignment::kAlone) {}
  /// Replaces the matching and updates owner_of.
  void adopt(MatchSolution solution);
  /// Sum of all costs, log-odds.
  [[nodiscard]] double total(const MatchProblem& problem) const {
    return problem.total(detection_of, owner_of);
  }
};

/// Grows a proposal from one bead. The neighbours of assigned beads follow one at a time: each takes the free
/// detection closest to the position that the mean step of its assigned neighbours predicts. The bead with
/// the shortest distance comes first; each assigned neighbour, up to four, counts as a shorter distance.
///
/// \pre bead `seed` is assigned in `present`
MatchSolution grow_proposal(const MatchProblem& problem, const MatchSolution& present, std::size_t seed);

/// Fusion move: a minimum cut chooses for each bead between the present matching and the proposal. The result
/// replaces the present matching if its sum is lower.
void fuse(const MatchProblem& problem, PresentMatching& present, MatchSolution proposal);

}  // namespace twincell::imaging
