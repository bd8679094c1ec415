#include "imaging/link/match_exchanges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/constants.hpp"

namespace twincell::imaging {

double MatchExchanges::neighbourhood_cost(std::size_t t, std::size_t excluded) const {
  double sum = 0;
  for (const std::size_t q : problem_.pairs_of[t])
    if (MatchProblem::other_of(problem_.pairs[q], t) != excluded)
      sum += problem_.pair_cost(problem_.pairs[q], present_.detection_of[problem_.pairs[q].a],
                                present_.detection_of[problem_.pairs[q].b]);
  for (const std::size_t o : problem_.far_of[t])
    if (o != excluded) sum += problem_.overlap(t, present_.detection_of[t], o, present_.detection_of[o]);
  return sum;
}

double MatchExchanges::cached_pair_cost(std::size_t t) {
  if (std::isnan(pair_cost_cache_[t])) pair_cost_cache_[t] = neighbourhood_cost(t, kNoBead);
  return pair_cost_cache_[t];
}

double MatchExchanges::rise_of(std::size_t t, std::int64_t k) {
  const std::int64_t was = present_.detection_of[t], rival = present_.owner_of[static_cast<std::size_t>(k)];
  const std::size_t o = rival < 0 ? kNoBead : static_cast<std::size_t>(rival);
  double rise = problem_.own_cost(t, k) - problem_.own_cost(t, was), most_gain = cached_pair_cost(t);
  if (o == kNoBead) {
    rise += (was >= 0 ? problem_.unused_cost[static_cast<std::size_t>(was)] : 0) -
            problem_.unused_cost[static_cast<std::size_t>(k)];
  } else {
    rise += problem_.own_cost(o, was) - problem_.own_cost(o, k);
    most_gain += cached_pair_cost(o);
  }
  if (rise - most_gain > kMatchCosts.margin_cap) return std::numeric_limits<double>::infinity();
  auto put = [&](std::size_t bead, std::int64_t to) {
    present_.detection_of[bead] = to;
    if (to >= 0) present_.owner_of[static_cast<std::size_t>(to)] = static_cast<std::int64_t>(bead);
  };
  auto pairs = [&] { return neighbourhood_cost(t, kNoBead) + (o == kNoBead ? 0 : neighbourhood_cost(o, t)); };
  rise -= pairs();
  if (o == kNoBead && was >= 0) present_.owner_of[static_cast<std::size_t>(was)] = Assignment::kAlone;
  put(t, k);
  if (o != kNoBead) put(o, was);
  rise += pairs();
  if (o == kNoBead) present_.owner_of[static_cast<std::size_t>(k)] = Assignment::kAlone;
  put(t, was);
  if (o != kNoBead) put(o, k);
  return rise;
}

// Pair costs of the beads of the chain, among each other and with their neighbours.
double MatchExchanges::chain_pair_cost() const {
  double sum = 0;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const std::size_t t = chain_[i];
    for (const std::size_t q : problem_.pairs_of[t])
      if (chain_position_[MatchProblem::other_of(problem_.pairs[q], t)] >= i)
        sum += problem_.pair_cost(problem_.pairs[q], present_.detection_of[problem_.pairs[q].a],
                                  present_.detection_of[problem_.pairs[q].b]);
    for (const std::size_t o : problem_.far_of[t])
      if (chain_position_[o] >= i)
        sum += problem_.overlap(t, present_.detection_of[t], o, present_.detection_of[o]);
  }
  return sum;
}

// If it is cheaper, each bead of the chain takes the detection of the next and the last takes k. `own`: rise
// of the single-bead costs and of the cost of unused detections.
bool MatchExchanges::close_chain(std::int64_t k, double own) {
  const double before = chain_pair_cost();
  std::array<std::int64_t, kMatchCosts.max_exchange> old{};
  for (std::size_t i = 0; i < chain_.size(); ++i) old[i] = present_.detection_of[chain_[i]];
  for (std::size_t i = 0; i < chain_.size(); ++i)
    present_.detection_of[chain_[i]] = i + 1 < chain_.size() ? old[i + 1] : k;
  if (own + chain_pair_cost() - before > -kMatchCosts.least_decrease) {
    for (std::size_t i = 0; i < chain_.size(); ++i) present_.detection_of[chain_[i]] = old[i];
    return false;
  }
  if (old[0] >= 0) present_.owner_of[static_cast<std::size_t>(old[0])] = Assignment::kAlone;
  for (const std::size_t t : chain_) {
    if (present_.detection_of[t] >= 0)
      present_.owner_of[static_cast<std::size_t>(present_.detection_of[t])] = static_cast<std::int64_t>(t);
    pair_cost_cache_[t] = kNaN;
    for (const std::size_t q : problem_.pairs_of[t])
      pair_cost_cache_[MatchProblem::other_of(problem_.pairs[q], t)] = kNaN;
    for (const std::size_t o : problem_.far_of[t]) pair_cost_cache_[o] = kNaN;
  }
  return true;
}

// The last bead of the chain takes the detection of the first, or an unused detection, or the detection of
// another bead, which then becomes the last. A chain is extended only if its own costs promise a gain with
// little help from the pair costs.
bool MatchExchanges::extend_chain(double own) {
  const std::size_t last = chain_.back();
  const std::int64_t was = present_.detection_of[chain_.front()];
  // Saving if the chain ends at an unused detection.
  const auto filled = [&](std::int64_t k) {
    return problem_.unused_cost[static_cast<std::size_t>(k)] -
           (was >= 0 ? problem_.unused_cost[static_cast<std::size_t>(was)] : 0);
  };
  const double most_filled = was >= 0 ? 0 : kMatchCosts.unused_detection_cost;
  double save = 0;
  for (const std::size_t t : chain_) save += cached_pair_cost(t);
  own -= problem_.own_cost(last, present_.detection_of[last]);
  if (chain_.size() > 1) {
    const double rise = own + problem_.own_cost(last, was);
    if (rise - save < -kMatchCosts.least_decrease && close_chain(was, rise)) return true;
  }
  for (std::size_t e = problem_.first[last]; e < problem_.first[last + 1]; ++e) {
    const std::int64_t k = problem_.choices[e].column, rival = present_.owner_of[static_cast<std::size_t>(k)];
    const double rise = own + problem_.choices[e].cost;
    if (rival < 0) {
      if (const double total = rise - filled(k);
          total - save < -kMatchCosts.least_decrease && close_chain(k, total))
        return true;
      continue;
    }
    const auto o = static_cast<std::size_t>(rival);
    if (chain_position_[o] != kNoBead || chain_.size() == kMatchCosts.max_exchange ||
        chains_ == kMatchCosts.max_chains)
      continue;
    const double best = rise - (problem_.own_cost(o, k) - cheapest_own_[o]) - most_filled;
    if (best - kMatchCosts.expected_pair_saving * (save + cached_pair_cost(o)) > 0) continue;
    chain_position_[o] = chain_.size();
    chain_.push_back(o);
    ++chains_;
    const bool changed = extend_chain(rise);
    chain_.pop_back();
    chain_position_[o] = kNoBead;
    if (changed) return true;
  }
  return false;
}

void MatchExchanges::improve() {
  pair_cost_cache_.assign(problem_.n(), kNaN);
  chain_position_.assign(problem_.n(), kNoBead);
  cheapest_own_.assign(problem_.n(), 0);
  for (const Edge& e : problem_.choices) cheapest_own_[e.row] = std::min(cheapest_own_[e.row], e.cost);
  auto change_from = [&](std::size_t t) {
    chain_.assign(1, t);
    chains_ = 0;
    chain_position_[t] = 0;
    const bool changed = extend_chain(0);
    chain_position_[t] = kNoBead;
    return changed;
  };
  // Each exchange is a gain; the limit stops a long series of tiny gains.
  std::size_t left = 4 * problem_.n();
  bool any = true;
  for (int round = 0; round < kMatchCosts.exchange_rounds && any; ++round) {
    any = false;
    for (std::size_t t = 0; t < problem_.n(); ++t)
      for (; left > 0 && change_from(t); --left) any = true;
  }
}

}  // namespace twincell::imaging
