#include "imaging/link/collective_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "imaging/link/min_cut.hpp"
#include "imaging/link/point_grid.hpp"

namespace twincell::imaging {

namespace {

/// The numbers of the matching, chosen on the cells of `bench link`. d: bead diameter. Costs are log-odds,
/// natural logarithm.
struct MatchCosts {
  // Pairs of neighbours.
  double neighbour_reach = 1.6;         ///< d; largest distance of neighbours
  std::size_t max_neighbours = 7;       ///< only the nearest so many are used
  double full_weight_reach = 1.2;       ///< d; distance up to which a pair has full weight
  double weight_at_reach = 0.6;         ///< weight of a pair at neighbour_reach
  double step_difference_width = 0.15;  ///< d; core width of the density of step differences
  double step_difference_exponent = 2;  ///< exponent of that density
  double step_difference_cap = 1.2;     ///< d; step difference beyond which the cost stays constant

  // Beads on crossing paths.
  double overlap_onset = 0.9;  ///< d; closest approach of the centres below which discs overlap
  double full_overlap = 0.75;  ///< d; closest approach at which one disc passes through the other
  double overlap_cost = 15;    ///< log-odds; cost at full_overlap and below
  double overlap_reach = 3;    ///< d; beads farther apart cannot meet within a frame

  // Unused detections.
  double unused_detection_cost = 8;      ///< log-odds
  double entering_detection_cost = 2;    ///< log-odds; the same if it may be a bead not seen before
  double closed_cell_unused_cost = 300;  ///< log-odds; final cost in a closed cell
  double double_use_cost = 100;          ///< log-odds; two beads on one detection; prevents it in a fusion

  // Closed-cell search for the detections of unassigned beads.
  std::size_t beads_per_unassigned =
      20;                      ///< it runs if at most 1 + n / beads_per_unassigned beads are unassigned
  int max_search_length = 40;  ///< beads in its longest chain
  std::size_t max_search_moves = 1000000;  ///< its moves per frame; each takes some tenths of a microsecond

  // Messages.
  int max_sweeps = 20;           ///< largest number of sweeps
  int stable_sweeps = 4;         ///< stop after so many sweeps without a change of a best choice
  double plain_share = 1;        ///< fraction of a belief that is sent on in plain message passing
  double tempered_share = 0.34;  ///< the same in tempered message passing

  // Grown proposals.
  int seeds = 5;                        ///< beads from which a proposal is grown
  double settled_neighbour_lead = 0.1;  ///< d; lead in the queue, as a distance, for each settled neighbour

  // Exchanges.
  std::size_t max_exchange = 4;  ///< beads that exchange detections together
  /// Chains tried from one bead. Around unassigned beads there are many. Without a limit frames took up to
  /// twice as long, and fewer links were wrong only where a seventieth was wrong before. With 300 chains, 14
  /// more of 16000 links were wrong.
  std::size_t max_chains = 1000;
  double expected_pair_saving = 0.1;  ///< fraction of the pair costs that a chain may be expected to save
  int exchange_rounds = 5;            ///< rounds of exchanges
  double margin_cap = 10;             ///< log-odds; a larger rise of the sum is not computed
  double least_decrease = 1e-6;       ///< log-odds; smallest decrease that counts as an improvement
};
constexpr MatchCosts kCosts;

constexpr std::int64_t kAlone = Assignment::kAlone;
constexpr std::int64_t kUnchanged = -2;  // in a proposal: unchanged
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// The matching of one frame and the searches that improve it.
class Matching {
 public:
  Matching(std::span<const PixelPoint> places, std::span<const PixelPoint> detections,
           std::span<const Edge> choices, double d, std::span<const std::uint8_t> newcomers)
      : places_(places), detections_(detections), choices_(choices), d_(d), first_(places.size() + 1, 0) {
    unused_cost_.assign(detections.size(), kCosts.unused_detection_cost);
    for (std::size_t k = 0; k < newcomers.size(); ++k)
      if (newcomers[k] != 0) unused_cost_[k] = kCosts.entering_detection_cost;
    for (const Edge& e : choices) ++first_[e.row + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    find_neighbours();
    find_compatible_choices();
  }
  CollectiveMatching solve(const MatchKnowledge& known);

 private:
  struct Pair {
    std::size_t a, b;
    double weight;
    std::size_t to_a, to_b;   // first message to each bead
    std::size_t first, last;  // range in `compatible_`
  };
  // Choices of two neighbours (index within each bead's choices) that cost less together than the cap.
  struct CompatibleChoices {
    std::uint16_t of_a, of_b;
    float cost;
  };
  using Solution = std::vector<std::int64_t>;  // detection per bead

  [[nodiscard]] std::size_t n() const { return places_.size(); }
  [[nodiscard]] PixelPoint step(std::size_t t, std::int64_t k) const {
    return detections_[static_cast<std::size_t>(k)] - places_[t];
  }
  [[nodiscard]] std::size_t other_of(const Pair& p, std::size_t t) const { return p.a == t ? p.b : p.a; }
  [[nodiscard]] static double step_difference_cost(double r2) {
    return kCosts.step_difference_exponent *
           std::log(1 + r2 / (kCosts.step_difference_width * kCosts.step_difference_width));
  }
  [[nodiscard]] static double capped_step_difference_cost() {
    static const double cost = step_difference_cost(kCosts.step_difference_cap * kCosts.step_difference_cap);
    return cost;
  }
  [[nodiscard]] double own_cost(std::size_t t, std::int64_t k) const;
  [[nodiscard]] double pair_cost(const Pair& p, std::int64_t ka, std::int64_t kb) const;
  [[nodiscard]] double overlap(PixelPoint before, PixelPoint change) const;
  [[nodiscard]] double overlap(std::size_t a, std::int64_t ka, std::size_t b, std::int64_t kb) const;
  [[nodiscard]] double total() const;
  [[nodiscard]] double neighbourhood_cost(std::size_t t, std::size_t excluded) const;
  void find_neighbours();
  void find_compatible_choices();
  void gather_beliefs(std::size_t t);
  void send_message(std::size_t from, const Pair& p, float share);
  bool send_exclusivity_messages();
  [[nodiscard]] Solution pass_messages(double share);
  [[nodiscard]] Solution grow_proposal(std::size_t seed) const;
  void adopt(Solution solution);
  void fuse(Solution proposal);
  [[nodiscard]] double cached_pair_cost(std::size_t t);
  double exchange_rise(std::size_t t, std::int64_t k);
  void exchange_detections();
  [[nodiscard]] double chain_pair_cost() const;
  bool close_chain(std::int64_t k, double own);
  bool extend_chain(double own);
  [[nodiscard]] double cost_at(std::size_t t, std::int64_t k, std::size_t next, std::size_t previous) const;
  bool find_detection_for(std::size_t unassigned);

  std::span<const PixelPoint> places_, detections_;
  std::span<const Edge> choices_;
  double d_;
  std::vector<std::size_t> first_;         // first choice of each bead
  std::vector<std::size_t> order_, rank_;  // beads sorted from the top downwards
  std::vector<Pair> pairs_;
  std::vector<std::vector<std::size_t>> pairs_of_, far_of_;
  std::vector<CompatibleChoices> compatible_;
  // State of the messages: between neighbours, the beliefs, and from the detection of each choice. Beliefs of
  // a bead: one per choice, then one for staying unassigned.
  std::vector<float> message_, belief_, exclusivity_;
  std::vector<std::size_t> best_choice_;
  // The present matching.
  std::vector<double> unused_cost_;  // cost of each detection if it is unused
  Solution current_;
  std::vector<std::int64_t> owner_;          // bead of each detection
  std::vector<double> cheapest_own_;         // cost of each bead's cheapest choice
  std::vector<std::size_t> chain_;           // beads that exchange detections
  std::vector<std::size_t> chain_position_;  // position of each bead in the chain
  std::size_t chains_ = 0;                   // chains tried from the first bead of the chain
  std::vector<double> pair_cost_cache_;      // pair costs of each bead
  std::size_t search_moves_ = 0;             // moves tried in the search for unassigned beads
};

void Matching::find_neighbours() {
  order_.resize(n());
  rank_.resize(n());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return places_[a].y_px < places_[b].y_px; });
  for (std::size_t i = 0; i < n(); ++i) rank_[order_[i]] = i;
  const double reach = kCosts.neighbour_reach * d_;
  // Neighbours: the nearest beads within reach, in either direction.
  std::vector<std::pair<std::size_t, std::size_t>> near_pairs;  // ranks
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < n(); ++i) {
    const PixelPoint p = places_[order_[i]];
    near.clear();
    auto look = [&](std::size_t j) {
      const double r2 = square(places_[order_[j]] - p);
      if (r2 < reach * reach) near.emplace_back(r2, j);
    };
    for (std::size_t j = i + 1; j < n() && places_[order_[j]].y_px - p.y_px < reach; ++j) look(j);
    for (std::size_t j = i; j-- > 0 && p.y_px - places_[order_[j]].y_px < reach;) look(j);
    std::sort(near.begin(), near.end());
    if (near.size() > kCosts.max_neighbours) near.resize(kCosts.max_neighbours);
    for (const auto& [r2, j] : near) near_pairs.emplace_back(std::min(i, j), std::max(i, j));
  }
  std::sort(near_pairs.begin(), near_pairs.end());
  near_pairs.erase(std::unique(near_pairs.begin(), near_pairs.end()), near_pairs.end());
  // Farther beads: only the cost of passing through each other applies to them.
  far_of_.resize(n());
  const double far = kCosts.overlap_reach * d_;
  for (std::size_t i = 0; i < n(); ++i)
    for (std::size_t j = i + 1; j < n() && places_[order_[j]].y_px - places_[order_[i]].y_px < far; ++j) {
      if (square(places_[order_[j]] - places_[order_[i]]) >= far * far ||
          std::binary_search(near_pairs.begin(), near_pairs.end(), std::pair{i, j}))
        continue;
      far_of_[order_[i]].push_back(order_[j]);
      far_of_[order_[j]].push_back(order_[i]);
    }
  // Pairs: only beads that have choices exchange messages.
  pairs_of_.resize(n());
  for (const auto& [i, j] : near_pairs) {
    const std::size_t a = order_[i], b = order_[j];
    if (first_[a] == first_[a + 1] || first_[b] == first_[b + 1]) continue;
    const double r = std::sqrt(square(places_[b] - places_[a])) / d_;
    const double loose =
        std::max(0.0, (r - kCosts.full_weight_reach) / (kCosts.neighbour_reach - kCosts.full_weight_reach));
    pairs_of_[a].push_back(pairs_.size());
    pairs_of_[b].push_back(pairs_.size());
    pairs_.push_back({a, b, 1 - (1 - kCosts.weight_at_reach) * loose, 0, 0, 0, 0});
  }
}

void Matching::find_compatible_choices() {
  std::size_t messages = 0;
  for (Pair& p : pairs_) {
    const std::size_t of_a = first_[p.a + 1] - first_[p.a], of_b = first_[p.b + 1] - first_[p.b];
    p.to_a = messages;
    p.to_b = messages + of_a + 1;
    messages += of_a + of_b + 2;
    p.first = compatible_.size();
    const PixelPoint between = places_[p.b] - places_[p.a];
    for (std::size_t k = 0; k < of_a; ++k) {
      const std::uint32_t to_a = choices_[first_[p.a] + k].column;
      const PixelPoint alike = detections_[to_a] + between;
      for (std::size_t l = 0; l < of_b; ++l) {
        const std::uint32_t to_b = choices_[first_[p.b] + l].column;
        const double r2 = square(detections_[to_b] - alike) / (d_ * d_);
        if (to_a == to_b || r2 >= kCosts.step_difference_cap * kCosts.step_difference_cap) continue;
        compatible_.push_back({static_cast<std::uint16_t>(k), static_cast<std::uint16_t>(l),
                               static_cast<float>(p.weight * step_difference_cost(r2))});
      }
    }
    p.last = compatible_.size();
  }
  message_.resize(messages);
  belief_.resize(choices_.size() + n());
  exclusivity_.resize(choices_.size());
}

double Matching::own_cost(std::size_t t, std::int64_t k) const {
  if (k < 0) return 0;
  for (std::size_t e = first_[t]; e < first_[t + 1]; ++e)
    if (choices_[e].column == k) return choices_[e].cost;
  return std::numeric_limits<double>::infinity();
}

double Matching::pair_cost(const Pair& p, std::int64_t ka, std::int64_t kb) const {
  if (ka < 0 || kb < 0) return p.weight * capped_step_difference_cost();
  const PixelPoint before = places_[p.b] - places_[p.a];
  const PixelPoint change =
      detections_[static_cast<std::size_t>(kb)] - detections_[static_cast<std::size_t>(ka)] - before;
  const double c2 = square(change);
  const double cost = p.weight * (c2 < kCosts.step_difference_cap * kCosts.step_difference_cap * d_ * d_
                                      ? step_difference_cost(c2 / (d_ * d_))
                                      : capped_step_difference_cost());
  return cost + overlap(before, change);
}

// Cost of straight paths on which two discs would overlap: discs of one layer do not pass through each other.
double Matching::overlap(PixelPoint before, PixelPoint change) const {
  const double c2 = square(change), dot = -(before.x_px * change.x_px + before.y_px * change.y_px);
  if (dot <= 0 || dot >= c2) return 0;  // closest at the start or the end, which are observed positions
  const double r2 = (square(before) - dot * dot / c2) / (d_ * d_);
  if (r2 >= kCosts.overlap_onset * kCosts.overlap_onset) return 0;
  return kCosts.overlap_cost * std::min(1.0, (kCosts.overlap_onset - std::sqrt(std::max(r2, 0.0))) /
                                                 (kCosts.overlap_onset - kCosts.full_overlap));
}

double Matching::overlap(std::size_t a, std::int64_t ka, std::size_t b, std::int64_t kb) const {
  if (ka < 0 || kb < 0) return 0;
  return overlap(places_[b] - places_[a], step(b, kb) - step(a, ka));
}

double Matching::total() const {
  double sum = 0;
  for (std::size_t t = 0; t < n(); ++t) sum += own_cost(t, current_[t]);
  for (const Pair& p : pairs_) sum += pair_cost(p, current_[p.a], current_[p.b]);
  for (std::size_t t = 0; t < n(); ++t)
    for (const std::size_t o : far_of_[t])
      if (o > t) sum += overlap(t, current_[t], o, current_[o]);
  for (std::size_t k = 0; k < owner_.size(); ++k) sum += owner_[k] < 0 ? unused_cost_[k] : 0;
  return sum;
}

// --- messages ---

void Matching::gather_beliefs(std::size_t t) {
  const std::size_t m = first_[t + 1] - first_[t];
  float* belief = &belief_[first_[t] + t];
  for (std::size_t k = 0; k < m; ++k)
    belief[k] = static_cast<float>(choices_[first_[t] + k].cost) + exclusivity_[first_[t] + k];
  belief[m] = 0;
  for (const std::size_t q : pairs_of_[t]) {
    const Pair& p = pairs_[q];
    const float* in = &message_[p.a == t ? p.to_a : p.to_b];
    for (std::size_t k = 0; k <= m; ++k) belief[k] += in[k];
  }
}

void Matching::send_message(std::size_t from, const Pair& p, float share) {
  const bool forth = p.a == from;
  const std::size_t to = forth ? p.b : p.a;
  const std::size_t m = first_[from + 1] - first_[from], m_to = first_[to + 1] - first_[to];
  const float* belief = &belief_[first_[from] + from];
  const float* in = &message_[forth ? p.to_a : p.to_b];
  float* out = &message_[forth ? p.to_b : p.to_a];
  const auto far = static_cast<float>(p.weight * capped_step_difference_cost());
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k <= m; ++k) least = std::min(least, share * belief[k] - in[k]);
  std::fill(out, out + m_to + 1, least + far);
  for (std::size_t q = p.first; q < p.last; ++q) {
    const CompatibleChoices& pair = compatible_[q];
    const std::size_t mine = forth ? pair.of_a : pair.of_b, theirs = forth ? pair.of_b : pair.of_a;
    out[theirs] = std::min(out[theirs], share * belief[mine] - in[mine] + pair.cost);
  }
  const float low = *std::min_element(out, out + m_to + 1);
  for (std::size_t k = 0; k <= m_to; ++k) out[k] -= low;
}

// Exclusivity messages: each detection sends each bead the extra cost of giving up this detection, which is
// the gain of the best rival or the cost of leaving the detection unused. Returns true if no bead has changed
// its best choice.
bool Matching::send_exclusivity_messages() {
  struct Rivals {
    float best, second;
    std::size_t who = std::numeric_limits<std::size_t>::max();
  };
  std::vector<Rivals> rivals;
  for (const double empty : unused_cost_)
    rivals.push_back({static_cast<float>(empty), static_cast<float>(empty)});
  bool same = true;
  for (std::size_t t = 0; t < n(); ++t) {
    gather_beliefs(t);
    const std::size_t m = first_[t + 1] - first_[t];
    const float* belief = &belief_[first_[t] + t];
    float best = belief[m], second = std::numeric_limits<float>::infinity();
    std::size_t which = m;
    for (std::size_t k = 0; k < m; ++k) {
      if (belief[k] < best) {
        second = std::exchange(best, belief[k]);
        which = k;
      } else {
        second = std::min(second, belief[k]);
      }
    }
    same = same && best_choice_[t] == which;
    best_choice_[t] = which;
    for (std::size_t k = 0; k < m; ++k) {
      const float preference = belief[k] - exclusivity_[first_[t] + k] - (k == which ? second : best);
      Rivals& r = rivals[choices_[first_[t] + k].column];
      if (preference < r.best) {
        r.second = std::exchange(r.best, preference);
        r.who = t;
      } else {
        r.second = std::min(r.second, preference);
      }
    }
  }
  for (std::size_t t = 0; t < n(); ++t)
    for (std::size_t e = first_[t]; e < first_[t + 1]; ++e) {
      const Rivals& r = rivals[choices_[e].column];
      exclusivity_[e] =
          0.5F * exclusivity_[e] - 0.5F * (r.who == t ? r.second : r.best);  // damped against oscillation
    }
  return same;
}

Matching::Solution Matching::pass_messages(double share) {
  std::fill(message_.begin(), message_.end(), 0.0F);
  std::fill(exclusivity_.begin(), exclusivity_.end(), 0.0F);
  best_choice_.assign(n(), 0);
  // Sweeps: alternately downwards and upwards until the best choices are stable.
  int stable = 0;
  for (int sweep = 0; sweep < kCosts.max_sweeps && stable < kCosts.stable_sweeps; ++sweep) {
    const bool downwards = sweep % 2 == 0;
    for (std::size_t i = 0; i < n(); ++i) {
      const std::size_t t = order_[downwards ? i : n() - 1 - i];
      gather_beliefs(t);
      for (const std::size_t q : pairs_of_[t])
        if ((rank_[other_of(pairs_[q], t)] > rank_[t]) == downwards)
          send_message(t, pairs_[q], static_cast<float>(share));
    }
    stable = send_exclusivity_messages() ? stable + 1 : 0;
  }
  // Rounding: the beliefs become costs of an assignment, which resolves the remaining conflicts.
  std::vector<Edge> edges(choices_.begin(), choices_.end());
  for (std::size_t t = 0; t < n(); ++t) {
    gather_beliefs(t);
    const float* belief = &belief_[first_[t] + t];
    const std::size_t m = first_[t + 1] - first_[t];
    for (std::size_t k = 0; k < m; ++k)
      edges[first_[t] + k].cost = static_cast<double>(belief[k] - belief[m]);
  }
  return assign(n(), detections_.size(), edges).column_of_row;
}

// --- proposals ---

void Matching::adopt(Solution solution) {
  current_ = std::move(solution);
  owner_.assign(detections_.size(), kAlone);
  for (std::size_t t = 0; t < n(); ++t)
    if (current_[t] >= 0) owner_[static_cast<std::size_t>(current_[t])] = static_cast<std::int64_t>(t);
}

// Proposal grown from one bead. Next is always the bead with the most settled neighbours and the detection
// closest to the position that their mean step predicts.
Matching::Solution Matching::grow_proposal(std::size_t seed) const {
  Solution solution(n(), kAlone);
  std::vector<std::uint8_t> taken(detections_.size(), 0), settled(n(), 0);
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>,
                      std::greater<>>
      queue;
  auto next_choice = [&](std::size_t t) {
    PixelPoint sum;
    double count = 0;
    for (const std::size_t q : pairs_of_[t]) {
      const std::size_t o = other_of(pairs_[q], t);
      if (settled[o] == 0) continue;
      sum = sum + step(o, solution[o]);
      count += 1;
    }
    const PixelPoint there = places_[t] + PixelPoint{sum.x_px / count, sum.y_px / count};
    std::pair<double, std::int64_t> best{std::numeric_limits<double>::infinity(), kAlone};
    for (std::size_t e = first_[t]; e < first_[t + 1]; ++e)
      if (const std::uint32_t k = choices_[e].column; taken[k] == 0)
        best = std::min(best, std::pair{square(detections_[k] - there), std::int64_t{k}});
    return std::pair{std::sqrt(best.first) / d_ - kCosts.settled_neighbour_lead * std::min(count, 4.0),
                     best.second};
  };
  auto settle = [&](std::size_t t, std::int64_t k) {
    solution[t] = k;
    settled[t] = 1;
    taken[static_cast<std::size_t>(k)] = 1;
    for (const std::size_t q : pairs_of_[t]) {
      const std::size_t o = other_of(pairs_[q], t);
      if (settled[o] != 0) continue;
      if (const auto [priority, detection] = next_choice(o); detection >= 0) queue.emplace(priority, o);
    }
  };
  settle(seed, current_[seed]);
  while (!queue.empty()) {
    const auto [priority, t] = queue.top();
    queue.pop();
    if (settled[t] != 0) continue;
    const auto [now, k] = next_choice(t);
    if (k < 0) continue;
    if (now > priority + kCosts.least_decrease)
      queue.emplace(now, t);
    else
      settle(t, k);
  }
  return solution;
}

// Fusion move: a minimum cut chooses for each bead between the present matching and the proposal.
void Matching::fuse(Solution proposal) {
  for (std::size_t t = 0; t < n(); ++t)
    if (proposal[t] == current_[t]) proposal[t] = kUnchanged;
  std::vector<std::int64_t> claimant(detections_.size(), kAlone);
  for (std::size_t t = 0; t < n(); ++t)
    if (proposal[t] >= 0) claimant[static_cast<std::size_t>(proposal[t])] = static_cast<std::int64_t>(t);
  std::vector<std::size_t> who, node(n(), kNone);
  for (std::size_t t = 0; t < n(); ++t) {
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
    move[v] = own_cost(who[v], proposal[who[v]]) - own_cost(who[v], current_[who[v]]);
  auto meet = [&](std::size_t ta, std::size_t tb, auto&& cost) {
    const std::size_t a = node[ta], b = node[tb];
    if (a == kNone && b == kNone) return;
    const double stay = cost(current_[ta], current_[tb]);
    if (b == kNone)
      move[a] += cost(proposal[ta], current_[tb]) - stay;
    else if (a == kNone)
      move[b] += cost(current_[ta], proposal[tb]) - stay;
    else
      two(a, b, stay, cost(current_[ta], proposal[tb]), cost(proposal[ta], current_[tb]),
          cost(proposal[ta], proposal[tb]));
  };
  for (const Pair& p : pairs_)
    meet(p.a, p.b, [&](std::int64_t ka, std::int64_t kb) { return pair_cost(p, ka, kb); });
  for (std::size_t t = 0; t < n(); ++t)
    for (const std::size_t o : far_of_[t])
      if (o > t) meet(t, o, [&](std::int64_t kt, std::int64_t ko) { return overlap(t, kt, o, ko); });
  // Detections: each is used at most once, and leaving it unused has a cost.
  for (std::size_t k = 0; k < detections_.size(); ++k) {
    const std::int64_t from = owner_[k], to = claimant[k];
    if (from < 0 && to >= 0) move[node[static_cast<std::size_t>(to)]] -= unused_cost_[k];
    if (from >= 0 && to < 0 && node[static_cast<std::size_t>(from)] != kNone)
      move[node[static_cast<std::size_t>(from)]] += unused_cost_[k];
    if (from >= 0 && to >= 0)
      two(node[static_cast<std::size_t>(from)], node[static_cast<std::size_t>(to)], 0, kCosts.double_use_cost,
          unused_cost_[k], 0);
  }
  for (std::size_t v = 0; v < who.size(); ++v) cut.move(v, move[v]);
  const std::vector<std::uint8_t> moves = cut.solve();
  // Acceptance: because of the rounding, the result may be inconsistent or more expensive.
  Solution joined = current_;
  for (std::size_t v = 0; v < who.size(); ++v)
    if (moves[v] != 0) joined[who[v]] = proposal[who[v]];
  std::vector<std::uint8_t> taken(detections_.size(), 0);
  for (const std::int64_t k : joined)
    if (k >= 0 && taken[static_cast<std::size_t>(k)]++ != 0) return;
  const double before = total();
  const Solution old = current_;
  adopt(joined);
  if (total() > before - kCosts.least_decrease) adopt(old);
}

// --- exchanges ---

double Matching::neighbourhood_cost(std::size_t t, std::size_t excluded) const {
  double sum = 0;
  for (const std::size_t q : pairs_of_[t])
    if (other_of(pairs_[q], t) != excluded)
      sum += pair_cost(pairs_[q], current_[pairs_[q].a], current_[pairs_[q].b]);
  for (const std::size_t o : far_of_[t])
    if (o != excluded) sum += overlap(t, current_[t], o, current_[o]);
  return sum;
}

double Matching::cached_pair_cost(std::size_t t) {
  if (std::isnan(pair_cost_cache_[t])) pair_cost_cache_[t] = neighbourhood_cost(t, kNone);
  return pair_cost_cache_[t];
}

// Rise of the sum if t takes k and the bead there takes the detection of t; infinity if it exceeds
// kCosts.margin_cap.
double Matching::exchange_rise(std::size_t t, std::int64_t k) {
  const std::int64_t was = current_[t], rival = owner_[static_cast<std::size_t>(k)];
  const std::size_t o = rival < 0 ? kNone : static_cast<std::size_t>(rival);
  double rise = own_cost(t, k) - own_cost(t, was), most_gain = cached_pair_cost(t);
  if (o == kNone) {
    rise += (was >= 0 ? unused_cost_[static_cast<std::size_t>(was)] : 0) -
            unused_cost_[static_cast<std::size_t>(k)];
  } else {
    rise += own_cost(o, was) - own_cost(o, k);
    most_gain += cached_pair_cost(o);
  }
  if (rise - most_gain > kCosts.margin_cap) return std::numeric_limits<double>::infinity();
  auto put = [&](std::size_t bead, std::int64_t to) {
    current_[bead] = to;
    if (to >= 0) owner_[static_cast<std::size_t>(to)] = static_cast<std::int64_t>(bead);
  };
  auto pairs = [&] { return neighbourhood_cost(t, kNone) + (o == kNone ? 0 : neighbourhood_cost(o, t)); };
  rise -= pairs();
  if (o == kNone && was >= 0) owner_[static_cast<std::size_t>(was)] = kAlone;
  put(t, k);
  if (o != kNone) put(o, was);
  rise += pairs();
  if (o == kNone) owner_[static_cast<std::size_t>(k)] = kAlone;
  put(t, was);
  if (o != kNone) put(o, k);
  return rise;
}

// Pair costs of the beads of the chain, among each other and with their neighbours.
double Matching::chain_pair_cost() const {
  double sum = 0;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const std::size_t t = chain_[i];
    for (const std::size_t q : pairs_of_[t])
      if (chain_position_[other_of(pairs_[q], t)] >= i)
        sum += pair_cost(pairs_[q], current_[pairs_[q].a], current_[pairs_[q].b]);
    for (const std::size_t o : far_of_[t])
      if (chain_position_[o] >= i) sum += overlap(t, current_[t], o, current_[o]);
  }
  return sum;
}

// If it is cheaper, each bead of the chain takes the detection of the next and the last takes k. `own`: rise
// of the single-bead costs and of the cost of unused detections.
bool Matching::close_chain(std::int64_t k, double own) {
  const double before = chain_pair_cost();
  std::array<std::int64_t, kCosts.max_exchange> old{};
  for (std::size_t i = 0; i < chain_.size(); ++i) old[i] = current_[chain_[i]];
  for (std::size_t i = 0; i < chain_.size(); ++i)
    current_[chain_[i]] = i + 1 < chain_.size() ? old[i + 1] : k;
  if (own + chain_pair_cost() - before > -kCosts.least_decrease) {
    for (std::size_t i = 0; i < chain_.size(); ++i) current_[chain_[i]] = old[i];
    return false;
  }
  if (old[0] >= 0) owner_[static_cast<std::size_t>(old[0])] = kAlone;
  for (const std::size_t t : chain_) {
    if (current_[t] >= 0) owner_[static_cast<std::size_t>(current_[t])] = static_cast<std::int64_t>(t);
    pair_cost_cache_[t] = kUnknown;
    for (const std::size_t q : pairs_of_[t]) pair_cost_cache_[other_of(pairs_[q], t)] = kUnknown;
    for (const std::size_t o : far_of_[t]) pair_cost_cache_[o] = kUnknown;
  }
  return true;
}

// The last bead of the chain takes the detection of the first, or an unused detection, or the detection of
// another bead, which then becomes the last. A chain is extended only if its own costs promise a gain with
// little help from the pair costs.
bool Matching::extend_chain(double own) {
  const std::size_t last = chain_.back();
  const std::int64_t was = current_[chain_.front()];
  // Saving if the chain ends at an unused detection.
  const auto filled = [&](std::int64_t k) {
    return unused_cost_[static_cast<std::size_t>(k)] -
           (was >= 0 ? unused_cost_[static_cast<std::size_t>(was)] : 0);
  };
  const double most_filled = was >= 0 ? 0 : kCosts.unused_detection_cost;
  double save = 0;
  for (const std::size_t t : chain_) save += cached_pair_cost(t);
  own -= own_cost(last, current_[last]);
  if (chain_.size() > 1) {
    const double rise = own + own_cost(last, was);
    if (rise - save < -kCosts.least_decrease && close_chain(was, rise)) return true;
  }
  for (std::size_t e = first_[last]; e < first_[last + 1]; ++e) {
    const std::int64_t k = choices_[e].column, rival = owner_[static_cast<std::size_t>(k)];
    const double rise = own + choices_[e].cost;
    if (rival < 0) {
      if (const double total = rise - filled(k);
          total - save < -kCosts.least_decrease && close_chain(k, total))
        return true;
      continue;
    }
    const auto o = static_cast<std::size_t>(rival);
    if (chain_position_[o] != kNone || chain_.size() == kCosts.max_exchange || chains_ == kCosts.max_chains)
      continue;
    const double best = rise - (own_cost(o, k) - cheapest_own_[o]) - most_filled;
    if (best - kCosts.expected_pair_saving * (save + cached_pair_cost(o)) > 0) continue;
    chain_position_[o] = chain_.size();
    chain_.push_back(o);
    ++chains_;
    const bool changed = extend_chain(rise);
    chain_.pop_back();
    chain_position_[o] = kNone;
    if (changed) return true;
  }
  return false;
}

void Matching::exchange_detections() {
  pair_cost_cache_.assign(n(), kUnknown);
  chain_position_.assign(n(), kNone);
  cheapest_own_.assign(n(), 0);
  for (const Edge& e : choices_) cheapest_own_[e.row] = std::min(cheapest_own_[e.row], e.cost);
  auto change_from = [&](std::size_t t) {
    chain_.assign(1, t);
    chains_ = 0;
    chain_position_[t] = 0;
    const bool changed = extend_chain(0);
    chain_position_[t] = kNone;
    return changed;
  };
  std::size_t left = 4 * n();  // each exchange is a gain; the limit stops a long series of tiny gains
  bool any = true;
  for (int round = 0; round < kCosts.exchange_rounds && any; ++round) {
    any = false;
    for (std::size_t t = 0; t < n(); ++t)
      for (; left > 0 && change_from(t); --left) any = true;
  }
}

// --- detections for unassigned beads ---

// Cost of t at k while all others stay, except `next`, which moves by the same step as t, and `previous`,
// which has taken the detection of t.
double Matching::cost_at(std::size_t t, std::int64_t k, std::size_t next, std::size_t previous) const {
  double sum = own_cost(t, k);
  for (const std::size_t q : pairs_of_[t]) {
    const Pair& p = pairs_[q];
    const std::size_t o = other_of(p, t);
    const std::int64_t mine = o == next ? current_[t] : k, theirs = o == previous ? current_[t] : current_[o];
    sum += p.a == t ? pair_cost(p, mine, theirs) : pair_cost(p, theirs, mine);
  }
  return sum;
}

// Label-correcting shortest-path search: the unassigned bead takes the detection of another bead, which takes
// the next one's, until an unused detection is reached. Chains are compared as if only the next bead in the
// chain moved along. The exact change of the sum is computed only for the cheapest chain.
bool Matching::find_detection_for(std::size_t unassigned) {
  struct Label {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t from = kNone;  // the bead that takes the detection
  };
  std::vector<Label> label(n());
  label[unassigned].cost = 0;
  Label last;  // the last bead of the best chain; `place` is its detection
  std::int64_t place = kAlone;
  auto in_chain_of = [&](std::size_t t, std::size_t o) {
    while (t != kNone && t != o) t = label[t].from;
    return t == o;
  };
  std::vector<std::size_t> changed{unassigned}, next;
  std::vector<std::uint8_t> queued(n(), 0);
  for (int length = 0;
       length < kCosts.max_search_length && !changed.empty() && search_moves_ < kCosts.max_search_moves;
       ++length) {
    for (const std::size_t t : changed) queued[t] = 0;
    next.clear();
    for (const std::size_t t : changed) {
      const std::size_t from = label[t].from;
      const double now = cost_at(t, current_[t], kNone, kNone);
      for (std::size_t e = first_[t]; e < first_[t + 1]; ++e) {
        const std::int64_t k = choices_[e].column, rival = owner_[static_cast<std::size_t>(k)];
        const std::size_t o = rival < 0 ? kNone : static_cast<std::size_t>(rival);
        if (o != kNone && in_chain_of(t, o)) continue;
        ++search_moves_;
        const double cost = label[t].cost + cost_at(t, k, o, from) - now;
        if (o == kNone) {
          if (cost < last.cost) {
            last = {cost, t};
            place = k;
          }
        } else if (cost < std::min(label[o].cost, kCosts.closed_cell_unused_cost) - kCosts.least_decrease) {
          label[o] = {cost, t};
          if (std::exchange(queued[o], std::uint8_t{1}) == 0) next.push_back(o);
        }
      }
    }
    changed.swap(next);
  }
  // Acceptance: apply the cheapest chain and keep it only if the exact sum falls.
  if (last.from == kNone) return false;
  const double before = total();
  const Solution old = current_;
  Solution solution = current_;
  for (std::size_t t = last.from; t != kNone; t = label[t].from) solution[t] = std::exchange(place, old[t]);
  adopt(solution);
  if (total() < before - kCosts.least_decrease) return true;
  adopt(old);
  return false;
}

CollectiveMatching Matching::solve(const MatchKnowledge& known) {
  // Start: the plain messages, or the given starting solution.
  const Solution plain = pass_messages(kCosts.plain_share), tempered = pass_messages(kCosts.tempered_share);
  adopt(plain);
  if (!known.initial.empty()) {
    Solution initial(known.initial.begin(), known.initial.end());
    for (std::size_t t = 0; t < n(); ++t)
      if (std::isinf(own_cost(t, initial[t]))) initial[t] = kAlone;
    adopt(std::move(initial));
  }
  // Improvement: fusions with the other solutions, then exchanges.
  fuse(tempered);
  for (std::size_t i = 0; i < kCosts.seeds && n() > 0; ++i) {
    const std::size_t seed = order_[(2 * i + 1) * n() / (2 * kCosts.seeds)];
    if (current_[seed] >= 0) fuse(grow_proposal(seed));
  }
  exchange_detections();
  const Solution unforced = current_;
  // Closed cell: detections for unassigned beads. If many beads are unassigned, the matching itself is
  // unreliable and the search would be slow.
  const auto unassigned = static_cast<std::size_t>(std::count(current_.begin(), current_.end(), kAlone));
  if (known.all_present && unassigned <= 1 + n() / kCosts.beads_per_unassigned) {
    std::fill(unused_cost_.begin(), unused_cost_.end(), kCosts.closed_cell_unused_cost);
    bool any = false;
    for (std::size_t t = 0; t < n(); ++t) any = (current_[t] < 0 && find_detection_for(t)) || any;
    if (any) exchange_detections();
  }
  // Margins: 0 where the searches disagree, else the cheapest exchange.
  CollectiveMatching match{current_, std::vector<double>(n(), std::numeric_limits<double>::infinity())};
  for (std::size_t t = 0; t < n(); ++t) {
    if (plain[t] != current_[t] || tempered[t] != current_[t] || unforced[t] != current_[t])
      match.margin[t] = 0;
    for (std::size_t e = first_[t]; current_[t] >= 0 && e < first_[t + 1]; ++e)
      if (current_[t] != choices_[e].column)
        match.margin[t] = std::min(match.margin[t], exchange_rise(t, choices_[e].column));
  }
  return match;
}

}  // namespace

CollectiveMatching match_collectively(std::span<const PixelPoint> places,
                                      std::span<const PixelPoint> detections, std::span<const Edge> choices,
                                      double diameter_px, const MatchKnowledge& known) {
  return Matching(places, detections, choices, diameter_px, known.newcomers).solve(known);
}

}  // namespace twincell::imaging
