#pragma once
/// \file
/// Exchanges of detections between few beads of a collective matching (collective_matching.hpp).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "imaging/link/match_problem.hpp"
#include "imaging/link/match_proposals.hpp"

namespace twincell::imaging {

/// Up to MatchCosts::max_exchange beads exchange detections along a closed or open chain.
class MatchExchanges {
 public:
  /// \param present is improved; both outlive this
  MatchExchanges(const MatchProblem& problem, PresentMatching& present)
      : problem_(problem), present_(present) {}
  /// Exchanges until no chain lowers the sum, or MatchCosts::exchange_rounds are over.
  void improve();
  /// Rise of the sum, log-odds, if t takes k and the bead there takes the detection of t; infinity if it
  /// exceeds MatchCosts::margin_cap.
  /// \pre improve() was called, and the matching has not changed since
  [[nodiscard]] double rise_of(std::size_t t, std::int64_t k);

 private:
  [[nodiscard]] double neighbourhood_cost(std::size_t t, std::size_t excluded) const;
  [[nodiscard]] double cached_pair_cost(std::size_t t);
  [[nodiscard]] double chain_pair_cost() const;
  bool close_chain(std::int64_t k, double own);
  bool extend_chain(double own);

  const MatchProblem& problem_;
  PresentMatching& present_;
  std::vector<double> cheapest_own_;         // cost of each bead's cheapest choice
  std::vector<std::size_t> chain_;           // beads that exchange detections
  std::vector<std::size_t> chain_position_;  // position of each bead in the chain
  std::size_t chains_ = 0;                   // chains tried from the first bead of the chain
  std::vector<double> pair_cost_cache_;      // pair costs of each bead
};

}  // namespace twincell::imaging
