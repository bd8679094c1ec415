#include "imaging/link/match_proposals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "imaging/link/min_cut.hpp"

namespace twincell::imaging {

namespace {

constexpr std::int64_t kUnchanged = -2;  // in a proposal: unchanged

}  // namespace

void PresentMatching::adopt(MatchSolution solution) {
  detection_of = std::move(solution);
  std::fill(owner_of.begin(), owner_of.end(), Assignment::kAlone);
  for (std::size_t t = 0; t < detection_of.size(); ++t)
    if (detection_of[t] >= 0)
      owner_of[static_cast<std::size_t>(detection_of[t])] = static_cast<std::int64_t>(t);
}

MatchSolution grow_proposal(const MatchProblem& problem, const MatchSolution& present, std::size_t seed) {
  MatchSolution solution(problem.n(), Assignment::kAlone);
  std::vector<std::uint8_t> taken(problem.detections.size(), 0), settled(problem.n(), 0);
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>,
                      std::greater<>>
      queue;
  auto next_choice = [&](std::size_t t) {
    PixelPoint sum;
    double count = 0;
    for (const std::size_t q : problem.pairs_of[t]) {
      const std::size_t o = MatchProblem::other_of(problem.pairs[q], t);
      if (settled[o] == 0) continue;
      sum = sum + problem.step(o, solution[o]);
      count += 1;
    }
    const PixelPoint there = problem.places[t] + PixelPoint{sum.x_px / count, sum.y_px / count};
    std::pair<double, std::int64_t> best{std::numeric_limits<double>::infinity(), Assignment::kAlone};
    for (std::size_t e = problem.first[t]; e < problem.first[t + 1]; ++e)
      if (const std::uint32_t k = problem.choices[e].column; taken[k] == 0)
        best = std::min(best, std::pair{square(problem.detections[k] - there), std::int64_t{k}});
    return std::pair{
        std::sqrt(best.first) / problem.d - kMatchCosts.settled_neighbour_lead * std::min(count, 4.0),
        best.second};
  };
  auto settle = [&](std::size_t t, std::int64_t k) {
    solution[t] = k;
    settled[t] = 1;
    taken[static_cast<std::size_t>(k)] = 1;
    for (const std::size_t q : problem.pairs_of[t]) {
      const std::size_t o = MatchProblem::other_of(problem.pairs[q], t);
      if (settled[o] != 0) continue;
      if (const auto [priority, detection] = next_choice(o); detection >= 0) queue.emplace(priority, o);
    }
  };
  settle(seed, present[seed]);
  while (!queue.empty()) {
    const auto [priority, t] = queue.top();
    queue.pop();
    if (settled[t] != 0) continue;
    const auto [now, k] = next_choice(t);
    if (k < 0) continue;
    if (now > priority + kMatchCosts.least_decrease)
      queue.emplace(now, t);
    else
      settle(t, k);
  }
  return solution;
}

void fuse(const MatchProblem& problem, PresentMatching& present, MatchSolution proposal) {
  const MatchSolution& current = present.detection_of;
  for (std::size_t t = 0; t < problem.n(); ++t)
    if (proposal[t] == current[t]) proposal[t] = kUnchanged;
  std::vector<std::int64_t> claimant(problem.detections.size(), Assignment::kAlone);
  for (std::size_t t = 0; t < problem.n(); ++t)
    if (proposal[t] >= 0) claimant[static_cast<std::size_t>(proposal[t])] = static_cast<std::int64_t>(t);
  std::vector<std::size_t> who, node(problem.n(), kNoBead);
  for (std::size_t t = 0; t < problem.n(); ++t) {
    if (proposal[t] == kUnchanged) continue;
    node[t] = who.size();
    who.push_back(t);
  }
  if (who.empty()) return;
  std::vector<double> move(who.size());
  MinCut cut(who.size());
  // Costs: both stay, only b moves, only a moves, both move. A term that no cut can represent is rounded
  // upwards.
  auto two = [&](std::size_t a, std::size_t b, double stay, double only_b, double only_a, double both) {
    move[a] += only_a - stay;
    move[b] += both - only_a;
    cut.stay_and_move(a, b, only_b + only_a - stay - both);
  };
  for (std::size_t v = 0; v < who.size(); ++v)
    move[v] = problem.own_cost(who[v], proposal[who[v]]) - problem.own_cost(who[v], current[who[v]]);
  auto meet = [&](std::size_t ta, std::size_t tb, auto&& cost) {
    const std::size_t a = node[ta], b = node[tb];
    if (a == kNoBead && b == kNoBead) return;
    const double stay = cost(current[ta], current[tb]);
    if (b == kNoBead)
      move[a] += cost(proposal[ta], current[tb]) - stay;
    else if (a == kNoBead)
      move[b] += cost(current[ta], proposal[tb]) - stay;
    else
      two(a, b, stay, cost(current[ta], proposal[tb]), cost(proposal[ta], current[tb]),
          cost(proposal[ta], proposal[tb]));
  };
  for (const MatchProblem::Pair& p : problem.pairs)
    meet(p.a, p.b, [&](std::int64_t ka, std::int64_t kb) { return problem.pair_cost(p, ka, kb); });
  for (std::size_t t = 0; t < problem.n(); ++t)
    for (const std::size_t o : problem.far_of[t])
      if (o > t) meet(t, o, [&](std::int64_t kt, std::int64_t ko) { return problem.overlap(t, kt, o, ko); });
  // Detections: each is used at most once, and leaving it unused has a cost.
  for (std::size_t k = 0; k < problem.detections.size(); ++k) {
    const std::int64_t from = present.owner_of[k], to = claimant[k];
    if (from < 0 && to >= 0) move[node[static_cast<std::size_t>(to)]] -= problem.unused_cost[k];
    if (from >= 0 && to < 0 && node[static_cast<std::size_t>(from)] != kNoBead)
      move[node[static_cast<std::size_t>(from)]] += problem.unused_cost[k];
    if (from >= 0 && to >= 0)
      two(node[static_cast<std::size_t>(from)], node[static_cast<std::size_t>(to)], 0,
          kMatchCosts.double_use_cost, problem.unused_cost[k], 0);
  }
  for (std::size_t v = 0; v < who.size(); ++v) cut.move(v, move[v]);
  const std::vector<std::uint8_t> moves = cut.solve();
  // Acceptance: because of the rounding, the result may be inconsistent or more expensive.
  MatchSolution joined = current;
  for (std::size_t v = 0; v < who.size(); ++v)
    if (moves[v] != 0) joined[who[v]] = proposal[who[v]];
  std::vector<std::uint8_t> taken(problem.detections.size(), 0);
  for (const std::int64_t k : joined)
    if (k >= 0 && taken[static_cast<std::size_t>(k)]++ != 0) return;
  const double before = present.total(problem);
  const MatchSolution old = current;
  present.adopt(joined);
  if (present.total(problem) > before - kMatchCosts.least_decrease) present.adopt(old);
}

}  // namespace twincell::imaging
