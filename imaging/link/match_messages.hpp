#pragma once
/// \file
/// Messages of a collective matching: min-sum belief propagation between neighbours and exclusivity messages
/// between rivals for a detection. Sources: collective_matching.hpp.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "imaging/link/match_problem.hpp"

namespace twincell::imaging {

/// Exchanges messages until the best choices are stable.
class MatchMessages {
 public:
  /// \param problem which outlives this
  explicit MatchMessages(const MatchProblem& problem);
  /// Starts without messages, passes them in sweeps, and resolves remaining conflicts by an assignment with
  /// the beliefs as costs.
  /// \param share fraction of a belief that is sent on: 1 plain, less: tempered
  [[nodiscard]] MatchSolution pass(double share);

 private:
  /// Where the messages of a pair are.
  struct Route {
    std::size_t to_a, to_b;   // first message to each bead
    std::size_t first, last;  // range in `compatible_`
  };
  // Choices of two neighbours (index within each bead's choices) that cost less together than the cap.
  struct CompatibleChoices {
    std::uint16_t of_a, of_b;
    float cost;
  };
  void gather_beliefs(std::size_t t);
  void send_message(std::size_t from, std::size_t pair, float share);
  bool send_exclusivity_messages();

  const MatchProblem& problem_;
  std::vector<Route> routes_;  // of each pair
  std::vector<CompatibleChoices> compatible_;
  // Messages between neighbours, the beliefs, and messages from the detection of each choice. Beliefs of a
  // bead: one per choice, then one for staying unassigned.
  std::vector<float> message_, belief_, exclusivity_;
  std::vector<std::size_t> best_choice_;
};

}  // namespace twincell::imaging
