#include "imaging/link/match_problem.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace twincell::imaging {

MatchProblem::MatchProblem(std::span<const PixelPoint> places_, std::span<const PixelPoint> detections_,
                           std::span<const Edge> choices_, double d_, std::span<const std::uint8_t> newcomers)
    : places(places_), detections(detections_), choices(choices_), d(d_), first(places_.size() + 1, 0) {
  unused_cost.assign(detections.size(), kMatchCosts.unused_detection_cost);
  for (std::size_t k = 0; k < newcomers.size(); ++k)
    if (newcomers[k] != 0) unused_cost[k] = kMatchCosts.entering_detection_cost;
  for (const Edge& e : choices) ++first[e.row + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  find_neighbours();
}

void MatchProblem::find_neighbours() {
  order.resize(n());
  rank.resize(n());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return places[a].y_px < places[b].y_px; });
  for (std::size_t i = 0; i < n(); ++i) rank[order[i]] = i;
  const double reach = kMatchCosts.neighbour_reach * d;
  // Neighbours: the nearest beads within reach, in either direction.
  std::vector<std::pair<std::size_t, std::size_t>> near_pairs;  // ranks
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < n(); ++i) {
    const PixelPoint p = places[order[i]];
    near.clear();
    auto look = [&](std::size_t j) {
      const double r2 = square(places[order[j]] - p);
      if (r2 < reach * reach) near.emplace_back(r2, j);
    };
    for (std::size_t j = i + 1; j < n() && places[order[j]].y_px - p.y_px < reach; ++j) look(j);
    for (std::size_t j = i; j-- > 0 && p.y_px - places[order[j]].y_px < reach;) look(j);
    std::sort(near.begin(), near.end());
    if (near.size() > kMatchCosts.max_neighbours) near.resize(kMatchCosts.max_neighbours);
    for (const auto& [r2, j] : near) near_pairs.emplace_back(std::min(i, j), std::max(i, j));
  }
  std::sort(near_pairs.begin(), near_pairs.end());
  near_pairs.erase(std::unique(near_pairs.begin(), near_pairs.end()), near_pairs.end());
  // Farther beads: only the cost of passing through each other applies to them.
  far_of.resize(n());
  const double far = kMatchCosts.overlap_reach * d;
  for (std::size_t i = 0; i < n(); ++i)
    for (std::size_t j = i + 1; j < n() && places[order[j]].y_px - places[order[i]].y_px < far; ++j) {
      if (square(places[order[j]] - places[order[i]]) >= far * far ||
          std::binary_search(near_pairs.begin(), near_pairs.end(), std::pair{i, j}))
        continue;
      far_of[order[i]].push_back(order[j]);
      far_of[order[j]].push_back(order[i]);
    }
  // Pairs: only beads that have choices exchange messages.
  pairs_of.resize(n());
  for (const auto& [i, j] : near_pairs) {
    const std::size_t a = order[i], b = order[j];
    if (first[a] == first[a + 1] || first[b] == first[b + 1]) continue;
    const double r = std::sqrt(square(places[b] - places[a])) / d;
    const double loose = std::max(0.0, (r - kMatchCosts.full_weight_reach) /
                                           (kMatchCosts.neighbour_reach - kMatchCosts.full_weight_reach));
    pairs_of[a].push_back(pairs.size());
    pairs_of[b].push_back(pairs.size());
    pairs.push_back({a, b, 1 - (1 - kMatchCosts.weight_at_reach) * loose});
  }
}

double MatchProblem::total(const MatchSolution& matching, const std::vector<std::int64_t>& owner) const {
  double sum = 0;
  for (std::size_t t = 0; t < n(); ++t) sum += own_cost(t, matching[t]);
  for (const Pair& p : pairs) sum += pair_cost(p, matching[p.a], matching[p.b]);
  for (std::size_t t = 0; t < n(); ++t)
    for (const std::size_t o : far_of[t])
      if (o > t) sum += overlap(t, matching[t], o, matching[o]);
  for (std::size_t k = 0; k < owner.size(); ++k) sum += owner[k] < 0 ? unused_cost[k] : 0;
  return sum;
}

}  // namespace twincell::imaging
