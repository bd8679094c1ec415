#include "imaging/link/collective_matching.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "imaging/link/match_exchanges.hpp"
#include "imaging/link/match_messages.hpp"
#include "imaging/link/match_problem.hpp"
#include "imaging/link/match_proposals.hpp"

namespace twincell::imaging {

namespace {

/// The steps of the matching, and the search for detections of unassigned beads in a closed cell.
class Matching {
 public:
  explicit Matching(MatchProblem problem)
      : problem_(std::move(problem)), present_(problem_.detections.size()) {}
  CollectiveMatching solve(const MatchKnowledge& known);

 private:
  [[nodiscard]] double cost_at(std::size_t t, std::int64_t k, std::size_t next, std::size_t previous) const;
  bool find_detection_for(std::size_t unassigned);

  MatchProblem problem_;
  PresentMatching present_;
  std::size_t search_moves_ = 0;  // moves tried in the search for unassigned beads
};

// Cost of t at k while all others stay, except `next`, which moves by the same step as t, and `previous`,
// which has taken the detection of t.
double Matching::cost_at(std::size_t t, std::int64_t k, std::size_t next, std::size_t previous) const {
  double sum = problem_.own_cost(t, k);
  for (const std::size_t q : problem_.pairs_of[t]) {
    const MatchProblem::Pair& p = problem_.pairs[q];
    const std::size_t o = MatchProblem::other_of(p, t);
    const std::int64_t mine = o == next ? present_.detection_of[t] : k,
                       theirs = o == previous ? present_.detection_of[t] : present_.detection_of[o];
    sum += p.a == t ? problem_.pair_cost(p, mine, theirs) : problem_.pair_cost(p, theirs, mine);
  }
  return sum;
}

// Label-correcting shortest-path search: the unassigned bead takes the detection of another bead, which takes
// the next one's, until an unused detection is reached. Chains are compared as if only the next bead in the
// chain moved along. The exact change of the sum is computed only for the cheapest chain.
bool Matching::find_detection_for(std::size_t unassigned) {
  struct Label {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t from = kNoBead;  // the bead that takes the detection
  };
  std::vector<Label> label(problem_.n());
  label[unassigned].cost = 0;
  Label last;  // the last bead of the best chain; `place` is its detection
  std::int64_t place = Assignment::kAlone;
  auto in_chain_of = [&](std::size_t t, std::size_t o) {
    while (t != kNoBead && t != o) t = label[t].from;
    return t == o;
  };
  std::vector<std::size_t> changed{unassigned}, next;
  std::vector<std::uint8_t> queued(problem_.n(), 0);
  for (int length = 0; length < kMatchCosts.max_search_length && !changed.empty() &&
                       search_moves_ < kMatchCosts.max_search_moves;
       ++length) {
    for (const std::size_t t : changed) queued[t] = 0;
    next.clear();
    for (const std::size_t t : changed) {
      const std::size_t from = label[t].from;
      const double now = cost_at(t, present_.detection_of[t], kNoBead, kNoBead);
      for (std::size_t e = problem_.first[t]; e < problem_.first[t + 1]; ++e) {
        const std::int64_t k = problem_.choices[e].column,
                           rival = present_.owner_of[static_cast<std::size_t>(k)];
        const std::size_t o = rival < 0 ? kNoBead : static_cast<std::size_t>(rival);
        if (o != kNoBead && in_chain_of(t, o)) continue;
        ++search_moves_;
        const double cost = label[t].cost + cost_at(t, k, o, from) - now;
        if (o == kNoBead) {
          if (cost < last.cost) {
            last = {cost, t};
            place = k;
          }
        } else if (cost < std::min(label[o].cost, kMatchCosts.closed_cell_unused_cost) -
                              kMatchCosts.least_decrease) {
          label[o] = {cost, t};
          if (std::exchange(queued[o], std::uint8_t{1}) == 0) next.push_back(o);
        }
      }
    }
    changed.swap(next);
  }
  // Acceptance: apply the cheapest chain and keep it only if the exact sum falls.
  if (last.from == kNoBead) return false;
  const double before = present_.total(problem_);
  const MatchSolution old = present_.detection_of;
  MatchSolution solution = present_.detection_of;
  for (std::size_t t = last.from; t != kNoBead; t = label[t].from) solution[t] = std::exchange(place, old[t]);
  present_.adopt(solution);
  if (present_.total(problem_) < before - kMatchCosts.least_decrease) return true;
  present_.adopt(old);
  return false;
}

CollectiveMatching Matching::solve(const MatchKnowledge& known) {
  // Start: the plain messages, or the given starting solution.
  MatchMessages messages(problem_);
  const MatchSolution plain = messages.pass(kMatchCosts.plain_share),
                      tempered = messages.pass(kMatchCosts.tempered_share);
  present_.adopt(plain);
  if (!known.initial.empty()) {
    MatchSolution initial(known.initial.begin(), known.initial.end());
    for (std::size_t t = 0; t < problem_.n(); ++t)
      if (std::isinf(problem_.own_cost(t, initial[t]))) initial[t] = Assignment::kAlone;
    present_.adopt(std::move(initial));
  }
  // Improvement: fusions with the other solutions, then exchanges.
  fuse(problem_, present_, tempered);
  for (std::size_t i = 0; i < kMatchCosts.seeds && problem_.n() > 0; ++i) {
    const std::size_t seed = problem_.order[(2 * i + 1) * problem_.n() / (2 * kMatchCosts.seeds)];
    if (present_.detection_of[seed] >= 0)
      fuse(problem_, present_, grow_proposal(problem_, present_.detection_of, seed));
  }
  MatchExchanges exchanges(problem_, present_);
  exchanges.improve();
  const MatchSolution unforced = present_.detection_of;
  // Closed cell: detections for unassigned beads. If many beads are unassigned, the matching itself is
  // unreliable and the search would be slow.
  const auto unassigned = static_cast<std::size_t>(
      std::count(present_.detection_of.begin(), present_.detection_of.end(), Assignment::kAlone));
  if (known.all_present && unassigned <= 1 + problem_.n() / kMatchCosts.beads_per_unassigned) {
    std::fill(problem_.unused_cost.begin(), problem_.unused_cost.end(), kMatchCosts.closed_cell_unused_cost);
    bool any = false;
    for (std::size_t t = 0; t < problem_.n(); ++t)
      any = (present_.detection_of[t] < 0 && find_detection_for(t)) || any;
    if (any) exchanges.improve();
  }
  // Margins: 0 where the searches disagree, else the cheapest exchange.
  CollectiveMatching match{present_.detection_of,
                           std::vector<double>(problem_.n(), std::numeric_limits<double>::infinity())};
  for (std::size_t t = 0; t < problem_.n(); ++t) {
    if (plain[t] != present_.detection_of[t] || tempered[t] != present_.detection_of[t] ||
        unforced[t] != present_.detection_of[t])
      match.margin[t] = 0;
    for (std::size_t e = problem_.first[t]; present_.detection_of[t] >= 0 && e < problem_.first[t + 1]; ++e)
      if (present_.detection_of[t] != problem_.choices[e].column)
        match.margin[t] = std::min(match.margin[t], exchanges.rise_of(t, problem_.choices[e].column));
  }
  return match;
}

}  // namespace

CollectiveMatching match_collectively(std::span<const PixelPoint> places,
                                      std::span<const PixelPoint> detections, std::span<const Edge> choices,
                                      double diameter_px, const MatchKnowledge& known) {
  return Matching({places, detections, choices, diameter_px, known.newcomers}).solve(known);
}

}  // namespace twincell::imaging
