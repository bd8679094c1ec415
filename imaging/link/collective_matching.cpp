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

namespace twincell {

namespace {

// Lengths in diameters, costs in logarithms of odds. Chosen on the cells of `bench link`.
constexpr double kReach = 1.6;               // of neighbours,
constexpr std::size_t kMostNeighbours = 7;   // the nearest so many
constexpr double kTouch = 1.2;               // up to which they count in full,
constexpr double kLoose = 0.6;               // and what the farthest count
constexpr double kWidth = 0.15;              // of the core of the density of the difference of two steps
constexpr double kScale = 2;                 // its exponent
constexpr double kAlike = 1.2;               // difference of steps beyond which nothing gets more expensive
constexpr double kBeside = 0.9;              // between centres on straight ways: nearer, discs overlap,
constexpr double kThrough = 0.75;            // and one passes through the other
constexpr double kPassing = 15;              // for that
constexpr double kMeeting = 3;               // beads farther apart do not meet within a frame
constexpr double kVoid = 8;                  // for a detection to which nobody goes,
constexpr double kNewcomer = 2;              // and for one that may be of a bead not seen before
constexpr double kLost = 300;                // the same where nobody can be lost,
constexpr std::size_t kFew = 20;             // one in so many of whom may be without a place,
constexpr int kLongestChain = 40;            // how many may hand on places then,
constexpr std::size_t kMostTries = 1000000;  // and places tried in all, each in some tenths of a microsecond
constexpr double kTwice = 100;               // for a detection to which two go; they never do
constexpr int kSweeps = 20;                  // of messages, fewer where nobody changes his mind,
constexpr int kSure = 4;                     // so many times on end
constexpr double kPlain = 1, kTempered = 0.34;  // share of a belief that is sent on
constexpr int kSeeds = 5;                       // beads from which a proposal is grown
constexpr double kTrust = 0.1;       // distance that a settled neighbour is worth in who goes first
constexpr std::size_t kLongest = 4;  // beads that change places together
// Chains tried that begin with one bead. Around lost beads there are many: without a limit frames took up to
// twice as long, and fewer links were wrong only where a seventieth was; with 300, 14 more of 16000 were.
constexpr std::size_t kMostChains = 1000;
constexpr double kHope = 0.1;   // share of what they pay for neighbours that they hope to save by it
constexpr int kRounds = 5;      // of changing places
constexpr double kMuch = 10;    // rise of the sum that is not worked out
constexpr double kLess = 1e-6;  // what counts as cheaper

constexpr std::int64_t kAlone = Assignment::kAlone;
constexpr std::int64_t kSame = -2;  // in a proposal: as it is
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

double square(PixelPoint a) {
  return a.x_px * a.x_px + a.y_px * a.y_px;
}
PixelPoint operator-(PixelPoint a, PixelPoint b) {
  return {a.x_px - b.x_px, a.y_px - b.y_px};
}
PixelPoint operator+(PixelPoint a, PixelPoint b) {
  return {a.x_px + b.x_px, a.y_px + b.y_px};
}

class Matching {
 public:
  Matching(std::span<const PixelPoint> places, std::span<const PixelPoint> detections,
           std::span<const Edge> choices, double d, std::span<const std::uint8_t> newcomers)
      : places_(places), detections_(detections), choices_(choices), d_(d), first_(places.size() + 1, 0) {
    void_.assign(detections.size(), kVoid);
    for (std::size_t k = 0; k < newcomers.size(); ++k)
      if (newcomers[k] != 0) void_[k] = kNewcomer;
    for (const Edge& e : choices) ++first_[e.row + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    find_neighbours();
    find_likes();
  }
  CollectiveMatching solve(const MatchKnowledge& known);

 private:
  struct Pair {
    std::size_t a, b;
    double weight;
    std::size_t to_a, to_b;   // messages
    std::size_t first, last;  // likes
  };
  // Choices of two neighbours, counted per bead, that are cheaper together than any two.
  struct Like {
    std::uint16_t of_a, of_b;
    float cost;
  };
  using Goals = std::vector<std::int64_t>;  // detection per bead

  [[nodiscard]] std::size_t n() const { return places_.size(); }
  [[nodiscard]] PixelPoint step(std::size_t t, std::int64_t k) const {
    return detections_[static_cast<std::size_t>(k)] - places_[t];
  }
  [[nodiscard]] std::size_t other_of(const Pair& p, std::size_t t) const { return p.a == t ? p.b : p.a; }
  [[nodiscard]] static double apart(double r2) { return kScale * std::log(1 + r2 / (kWidth * kWidth)); }
  [[nodiscard]] static double most() {
    static const double cost = apart(kAlike * kAlike);
    return cost;
  }
  [[nodiscard]] double own_cost(std::size_t t, std::int64_t k) const;
  [[nodiscard]] double pair_cost(const Pair& p, std::int64_t ka, std::int64_t kb) const;
  [[nodiscard]] double overlap(PixelPoint before, PixelPoint change) const;
  [[nodiscard]] double overlap(std::size_t a, std::int64_t ka, std::size_t b, std::int64_t kb) const;
  [[nodiscard]] double total() const;
  [[nodiscard]] double around(std::size_t t, std::size_t but) const;
  void find_neighbours();
  void find_likes();
  void gather(std::size_t t);
  void send(std::size_t from, const Pair& p, float share);
  bool let_rivals_speak();
  [[nodiscard]] Goals exchange_messages(double share);
  [[nodiscard]] Goals grown_from(std::size_t seed) const;
  void adopt(Goals goals);
  void fuse(Goals proposal);
  [[nodiscard]] double standing(std::size_t t);
  double change(std::size_t t, std::int64_t k);
  void change_places();
  [[nodiscard]] double shared() const;
  bool close(std::int64_t k, double own);
  bool extend(double own);
  [[nodiscard]] double paid(std::size_t t, std::int64_t k, std::size_t but, std::size_t before) const;
  bool find_place(std::size_t lost);

  std::span<const PixelPoint> places_, detections_;
  std::span<const Edge> choices_;
  double d_;
  std::vector<std::size_t> first_;         // choice of each bead
  std::vector<std::size_t> order_, rank_;  // from the top downwards
  std::vector<Pair> pairs_;
  std::vector<std::vector<std::size_t>> pairs_of_, far_of_;
  std::vector<Like> likes_;
  // Of the messages. Beliefs of a bead: its choices, then going nowhere.
  std::vector<float> message_, belief_, claim_;
  std::vector<std::size_t> favourite_;
  // The match.
  std::vector<double> void_;  // per detection, if nobody goes there
  Goals goal_;
  std::vector<std::int64_t> owner_;  // bead per detection
  std::vector<double> least_own_;    // cheapest choice of a bead
  std::vector<std::size_t> chain_;   // beads that change places,
  std::vector<std::size_t> turn_;    // and where in it each bead is
  std::size_t chains_ = 0;           // tried that begin with its first
  std::vector<double> standing_;     // what a bead pays for its neighbours
  std::size_t tries_ = 0;            // of places for beads that have none
};

void Matching::find_neighbours() {
  order_.resize(n());
  rank_.resize(n());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return places_[a].y_px < places_[b].y_px; });
  for (std::size_t i = 0; i < n(); ++i) rank_[order_[i]] = i;
  const double reach = kReach * d_;
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
    if (near.size() > kMostNeighbours) near.resize(kMostNeighbours);
    for (const auto& [r2, j] : near) near_pairs.emplace_back(std::min(i, j), std::max(i, j));
  }
  std::sort(near_pairs.begin(), near_pairs.end());
  near_pairs.erase(std::unique(near_pairs.begin(), near_pairs.end()), near_pairs.end());
  far_of_.resize(n());
  const double far = kMeeting * d_;
  for (std::size_t i = 0; i < n(); ++i)
    for (std::size_t j = i + 1; j < n() && places_[order_[j]].y_px - places_[order_[i]].y_px < far; ++j) {
      if (square(places_[order_[j]] - places_[order_[i]]) >= far * far ||
          std::binary_search(near_pairs.begin(), near_pairs.end(), std::pair{i, j}))
        continue;
      far_of_[order_[i]].push_back(order_[j]);
      far_of_[order_[j]].push_back(order_[i]);
    }
  pairs_of_.resize(n());
  for (const auto& [i, j] : near_pairs) {
    const std::size_t a = order_[i], b = order_[j];
    if (first_[a] == first_[a + 1] || first_[b] == first_[b + 1]) continue;
    const double r = std::sqrt(square(places_[b] - places_[a])) / d_;
    const double loose = std::max(0.0, (r - kTouch) / (kReach - kTouch));
    pairs_of_[a].push_back(pairs_.size());
    pairs_of_[b].push_back(pairs_.size());
    pairs_.push_back({a, b, 1 - (1 - kLoose) * loose, 0, 0, 0, 0});
  }
}

void Matching::find_likes() {
  std::size_t messages = 0;
  for (Pair& p : pairs_) {
    const std::size_t of_a = first_[p.a + 1] - first_[p.a], of_b = first_[p.b + 1] - first_[p.b];
    p.to_a = messages;
    p.to_b = messages + of_a + 1;
    messages += of_a + of_b + 2;
    p.first = likes_.size();
    const PixelPoint between = places_[p.b] - places_[p.a];
    for (std::size_t k = 0; k < of_a; ++k) {
      const std::uint32_t to_a = choices_[first_[p.a] + k].column;
      const PixelPoint alike = detections_[to_a] + between;
      for (std::size_t l = 0; l < of_b; ++l) {
        const std::uint32_t to_b = choices_[first_[p.b] + l].column;
        const double r2 = square(detections_[to_b] - alike) / (d_ * d_);
        if (to_a == to_b || r2 >= kAlike * kAlike) continue;
        likes_.push_back({static_cast<std::uint16_t>(k), static_cast<std::uint16_t>(l),
                          static_cast<float>(p.weight * apart(r2))});
      }
    }
    p.last = likes_.size();
  }
  message_.resize(messages);
  belief_.resize(choices_.size() + n());
  claim_.resize(choices_.size());
}

double Matching::own_cost(std::size_t t, std::int64_t k) const {
  if (k < 0) return 0;
  for (std::size_t e = first_[t]; e < first_[t + 1]; ++e)
    if (choices_[e].column == k) return choices_[e].cost;
  return std::numeric_limits<double>::infinity();
}

double Matching::pair_cost(const Pair& p, std::int64_t ka, std::int64_t kb) const {
  if (ka < 0 || kb < 0) return p.weight * most();
  const PixelPoint before = places_[p.b] - places_[p.a];
  const PixelPoint change =
      detections_[static_cast<std::size_t>(kb)] - detections_[static_cast<std::size_t>(ka)] - before;
  const double c2 = square(change);
  const double cost = p.weight * (c2 < kAlike * kAlike * d_ * d_ ? apart(c2 / (d_ * d_)) : most());
  return cost + overlap(before, change);
}

// Discs of one layer do not pass through each other: the price of straight ways on which two would overlap.
double Matching::overlap(PixelPoint before, PixelPoint change) const {
  const double c2 = square(change), dot = -(before.x_px * change.x_px + before.y_px * change.y_px);
  if (dot <= 0 || dot >= c2) return 0;  // nearest where they begin or end, which is as it is
  const double r2 = (square(before) - dot * dot / c2) / (d_ * d_);
  if (r2 >= kBeside * kBeside) return 0;
  return kPassing * std::min(1.0, (kBeside - std::sqrt(std::max(r2, 0.0))) / (kBeside - kThrough));
}

double Matching::overlap(std::size_t a, std::int64_t ka, std::size_t b, std::int64_t kb) const {
  if (ka < 0 || kb < 0) return 0;
  return overlap(places_[b] - places_[a], step(b, kb) - step(a, ka));
}

double Matching::total() const {
  double sum = 0;
  for (std::size_t t = 0; t < n(); ++t) sum += own_cost(t, goal_[t]);
  for (const Pair& p : pairs_) sum += pair_cost(p, goal_[p.a], goal_[p.b]);
  for (std::size_t t = 0; t < n(); ++t)
    for (const std::size_t o : far_of_[t])
      if (o > t) sum += overlap(t, goal_[t], o, goal_[o]);
  for (std::size_t k = 0; k < owner_.size(); ++k) sum += owner_[k] < 0 ? void_[k] : 0;
  return sum;
}

// --- messages ---

void Matching::gather(std::size_t t) {
  const std::size_t m = first_[t + 1] - first_[t];
  float* belief = &belief_[first_[t] + t];
  for (std::size_t k = 0; k < m; ++k)
    belief[k] = static_cast<float>(choices_[first_[t] + k].cost) + claim_[first_[t] + k];
  belief[m] = 0;
  for (const std::size_t q : pairs_of_[t]) {
    const Pair& p = pairs_[q];
    const float* in = &message_[p.a == t ? p.to_a : p.to_b];
    for (std::size_t k = 0; k <= m; ++k) belief[k] += in[k];
  }
}

void Matching::send(std::size_t from, const Pair& p, float share) {
  const bool forth = p.a == from;
  const std::size_t to = forth ? p.b : p.a;
  const std::size_t m = first_[from + 1] - first_[from], m_to = first_[to + 1] - first_[to];
  const float* belief = &belief_[first_[from] + from];
  const float* in = &message_[forth ? p.to_a : p.to_b];
  float* out = &message_[forth ? p.to_b : p.to_a];
  const auto far = static_cast<float>(p.weight * most());
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k <= m; ++k) least = std::min(least, share * belief[k] - in[k]);
  std::fill(out, out + m_to + 1, least + far);
  for (std::size_t q = p.first; q < p.last; ++q) {
    const Like& like = likes_[q];
    const std::size_t mine = forth ? like.of_a : like.of_b, theirs = forth ? like.of_b : like.of_a;
    out[theirs] = std::min(out[theirs], share * belief[mine] - in[mine] + like.cost);
  }
  const float low = *std::min_element(out, out + m_to + 1);
  for (std::size_t k = 0; k <= m_to; ++k) out[k] -= low;
}

// Each detection tells each bead how much more expensive it would be if the bead went elsewhere: as much as
// the keenest rival gains, or as it costs that nobody goes there. True: no bead has changed its mind.
bool Matching::let_rivals_speak() {
  struct Rivals {
    float best, second;
    std::size_t who = std::numeric_limits<std::size_t>::max();
  };
  std::vector<Rivals> rivals;
  for (const double empty : void_) rivals.push_back({static_cast<float>(empty), static_cast<float>(empty)});
  bool same = true;
  for (std::size_t t = 0; t < n(); ++t) {
    gather(t);
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
    same = same && favourite_[t] == which;
    favourite_[t] = which;
    for (std::size_t k = 0; k < m; ++k) {
      const float wish = belief[k] - claim_[first_[t] + k] - (k == which ? second : best);
      Rivals& r = rivals[choices_[first_[t] + k].column];
      if (wish < r.best) {
        r.second = std::exchange(r.best, wish);
        r.who = t;
      } else {
        r.second = std::min(r.second, wish);
      }
    }
  }
  for (std::size_t t = 0; t < n(); ++t)
    for (std::size_t e = first_[t]; e < first_[t + 1]; ++e) {
      const Rivals& r = rivals[choices_[e].column];
      claim_[e] = 0.5F * claim_[e] - 0.5F * (r.who == t ? r.second : r.best);  // halved, or it swings
    }
  return same;
}

Matching::Goals Matching::exchange_messages(double share) {
  std::fill(message_.begin(), message_.end(), 0.0F);
  std::fill(claim_.begin(), claim_.end(), 0.0F);
  favourite_.assign(n(), 0);
  int sure = 0;
  for (int sweep = 0; sweep < kSweeps && sure < kSure; ++sweep) {
    const bool downwards = sweep % 2 == 0;
    for (std::size_t i = 0; i < n(); ++i) {
      const std::size_t t = order_[downwards ? i : n() - 1 - i];
      gather(t);
      for (const std::size_t q : pairs_of_[t])
        if ((rank_[other_of(pairs_[q], t)] > rank_[t]) == downwards)
          send(t, pairs_[q], static_cast<float>(share));
    }
    sure = let_rivals_speak() ? sure + 1 : 0;
  }
  std::vector<Edge> edges(choices_.begin(), choices_.end());
  for (std::size_t t = 0; t < n(); ++t) {
    gather(t);
    const float* belief = &belief_[first_[t] + t];
    const std::size_t m = first_[t + 1] - first_[t];
    for (std::size_t k = 0; k < m; ++k)
      edges[first_[t] + k].cost = static_cast<double>(belief[k] - belief[m]);
  }
  return assign(n(), detections_.size(), edges).column_of_row;
}

// --- proposals ---

void Matching::adopt(Goals goals) {
  goal_ = std::move(goals);
  owner_.assign(detections_.size(), kAlone);
  for (std::size_t t = 0; t < n(); ++t)
    if (goal_[t] >= 0) owner_[static_cast<std::size_t>(goal_[t])] = static_cast<std::int64_t>(t);
}

// Who has most settled neighbours and meets best where their mean step leads goes first.
Matching::Goals Matching::grown_from(std::size_t seed) const {
  Goals goals(n(), kAlone);
  std::vector<std::uint8_t> taken(detections_.size(), 0), settled(n(), 0);
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>,
                      std::greater<>>
      queue;
  auto wish = [&](std::size_t t) {
    PixelPoint sum;
    double count = 0;
    for (const std::size_t q : pairs_of_[t]) {
      const std::size_t o = other_of(pairs_[q], t);
      if (settled[o] == 0) continue;
      sum = sum + step(o, goals[o]);
      count += 1;
    }
    const PixelPoint there = places_[t] + PixelPoint{sum.x_px / count, sum.y_px / count};
    std::pair<double, std::int64_t> best{std::numeric_limits<double>::infinity(), kAlone};
    for (std::size_t e = first_[t]; e < first_[t + 1]; ++e)
      if (const std::uint32_t k = choices_[e].column; taken[k] == 0)
        best = std::min(best, std::pair{square(detections_[k] - there), std::int64_t{k}});
    return std::pair{std::sqrt(best.first) / d_ - kTrust * std::min(count, 4.0), best.second};
  };
  auto settle = [&](std::size_t t, std::int64_t k) {
    goals[t] = k;
    settled[t] = 1;
    taken[static_cast<std::size_t>(k)] = 1;
    for (const std::size_t q : pairs_of_[t]) {
      const std::size_t o = other_of(pairs_[q], t);
      if (settled[o] != 0) continue;
      if (const auto [haste, goal] = wish(o); goal >= 0) queue.emplace(haste, o);
    }
  };
  settle(seed, goal_[seed]);
  while (!queue.empty()) {
    const auto [haste, t] = queue.top();
    queue.pop();
    if (settled[t] != 0) continue;
    const auto [now, k] = wish(t);
    if (k < 0) continue;
    if (now > haste + kLess)
      queue.emplace(now, t);
    else
      settle(t, k);
  }
  return goals;
}

// Of the match and a proposal the cheaper, bead by bead, for all beads at once.
void Matching::fuse(Goals proposal) {
  for (std::size_t t = 0; t < n(); ++t)
    if (proposal[t] == goal_[t]) proposal[t] = kSame;
  std::vector<std::int64_t> claimant(detections_.size(), kAlone);
  for (std::size_t t = 0; t < n(); ++t)
    if (proposal[t] >= 0) claimant[static_cast<std::size_t>(proposal[t])] = static_cast<std::int64_t>(t);
  std::vector<std::size_t> who, node(n(), kNone);
  for (std::size_t t = 0; t < n(); ++t) {
    if (proposal[t] == kSame) continue;
    node[t] = who.size();
    who.push_back(t);
  }
  if (who.empty()) return;
  std::vector<double> move(who.size());
  MinCut cut(who.size());
  // Costs of both staying, only b moving, only a moving, both moving. What no cut can say is rounded upwards.
  auto two = [&](std::size_t a, std::size_t b, double stay, double only_b, double only_a, double both) {
    move[a] += only_a - stay;
    move[b] += both - only_a;
    cut.stay_and_move(a, b, only_b + only_a - stay - both);
  };
  for (std::size_t v = 0; v < who.size(); ++v)
    move[v] = own_cost(who[v], proposal[who[v]]) - own_cost(who[v], goal_[who[v]]);
  auto meet = [&](std::size_t ta, std::size_t tb, auto&& cost) {
    const std::size_t a = node[ta], b = node[tb];
    if (a == kNone && b == kNone) return;
    const double stay = cost(goal_[ta], goal_[tb]);
    if (b == kNone)
      move[a] += cost(proposal[ta], goal_[tb]) - stay;
    else if (a == kNone)
      move[b] += cost(goal_[ta], proposal[tb]) - stay;
    else
      two(a, b, stay, cost(goal_[ta], proposal[tb]), cost(proposal[ta], goal_[tb]),
          cost(proposal[ta], proposal[tb]));
  };
  for (const Pair& p : pairs_)
    meet(p.a, p.b, [&](std::int64_t ka, std::int64_t kb) { return pair_cost(p, ka, kb); });
  for (std::size_t t = 0; t < n(); ++t)
    for (const std::size_t o : far_of_[t])
      if (o > t) meet(t, o, [&](std::int64_t kt, std::int64_t ko) { return overlap(t, kt, o, ko); });
  for (std::size_t k = 0; k < detections_.size(); ++k) {
    const std::int64_t from = owner_[k], to = claimant[k];
    if (from < 0 && to >= 0) move[node[static_cast<std::size_t>(to)]] -= void_[k];
    if (from >= 0 && to < 0 && node[static_cast<std::size_t>(from)] != kNone)
      move[node[static_cast<std::size_t>(from)]] += void_[k];
    if (from >= 0 && to >= 0)
      two(node[static_cast<std::size_t>(from)], node[static_cast<std::size_t>(to)], 0, kTwice, void_[k], 0);
  }
  for (std::size_t v = 0; v < who.size(); ++v) cut.move(v, move[v]);
  const std::vector<std::uint8_t> moves = cut.solve();
  Goals joined = goal_;
  for (std::size_t v = 0; v < who.size(); ++v)
    if (moves[v] != 0) joined[who[v]] = proposal[who[v]];
  std::vector<std::uint8_t> taken(detections_.size(), 0);
  for (const std::int64_t k : joined)
    if (k >= 0 && taken[static_cast<std::size_t>(k)]++ != 0) return;
  const double before = total();
  const Goals old = goal_;
  adopt(joined);
  if (total() > before - kLess) adopt(old);
}

// --- places that are changed ---

double Matching::around(std::size_t t, std::size_t but) const {
  double sum = 0;
  for (const std::size_t q : pairs_of_[t])
    if (other_of(pairs_[q], t) != but) sum += pair_cost(pairs_[q], goal_[pairs_[q].a], goal_[pairs_[q].b]);
  for (const std::size_t o : far_of_[t])
    if (o != but) sum += overlap(t, goal_[t], o, goal_[o]);
  return sum;
}

double Matching::standing(std::size_t t) {
  if (std::isnan(standing_[t])) standing_[t] = around(t, kNone);
  return standing_[t];
}

// What it costs that t goes to k and the bead there goes where t was; infinity if that is much.
double Matching::change(std::size_t t, std::int64_t k) {
  const std::int64_t was = goal_[t], rival = owner_[static_cast<std::size_t>(k)];
  const std::size_t o = rival < 0 ? kNone : static_cast<std::size_t>(rival);
  double rise = own_cost(t, k) - own_cost(t, was), most_gain = standing(t);
  if (o == kNone) {
    rise += (was >= 0 ? void_[static_cast<std::size_t>(was)] : 0) - void_[static_cast<std::size_t>(k)];
  } else {
    rise += own_cost(o, was) - own_cost(o, k);
    most_gain += standing(o);
  }
  if (rise - most_gain > kMuch) return std::numeric_limits<double>::infinity();
  auto put = [&](std::size_t bead, std::int64_t to) {
    goal_[bead] = to;
    if (to >= 0) owner_[static_cast<std::size_t>(to)] = static_cast<std::int64_t>(bead);
  };
  auto pairs = [&] { return around(t, kNone) + (o == kNone ? 0 : around(o, t)); };
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

// What the beads of the chain pay for each other and for their neighbours.
double Matching::shared() const {
  double sum = 0;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const std::size_t t = chain_[i];
    for (const std::size_t q : pairs_of_[t])
      if (turn_[other_of(pairs_[q], t)] >= i)
        sum += pair_cost(pairs_[q], goal_[pairs_[q].a], goal_[pairs_[q].b]);
    for (const std::size_t o : far_of_[t])
      if (turn_[o] >= i) sum += overlap(t, goal_[t], o, goal_[o]);
  }
  return sum;
}

// Each bead of the chain takes the place of the next and the last goes to k, if that is cheaper. `own`: what
// they pay more by themselves and for places left over.
bool Matching::close(std::int64_t k, double own) {
  const double before = shared();
  std::array<std::int64_t, kLongest> old{};
  for (std::size_t i = 0; i < chain_.size(); ++i) old[i] = goal_[chain_[i]];
  for (std::size_t i = 0; i < chain_.size(); ++i) goal_[chain_[i]] = i + 1 < chain_.size() ? old[i + 1] : k;
  if (own + shared() - before > -kLess) {
    for (std::size_t i = 0; i < chain_.size(); ++i) goal_[chain_[i]] = old[i];
    return false;
  }
  if (old[0] >= 0) owner_[static_cast<std::size_t>(old[0])] = kAlone;
  for (const std::size_t t : chain_) {
    if (goal_[t] >= 0) owner_[static_cast<std::size_t>(goal_[t])] = static_cast<std::int64_t>(t);
    standing_[t] = kUnknown;
    for (const std::size_t q : pairs_of_[t]) standing_[other_of(pairs_[q], t)] = kUnknown;
    for (const std::size_t o : far_of_[t]) standing_[o] = kUnknown;
  }
  return true;
}

// The last of the chain goes where the first was, or to a place left over, or to where somebody is, who
// becomes the last. All of it is tried whose first steps promise a gain without much help of neighbours.
bool Matching::extend(double own) {
  const std::size_t last = chain_.back();
  const std::int64_t was = goal_[chain_.front()];
  // What is saved if the chain ends at a place that nobody had.
  const auto filled = [&](std::int64_t k) {
    return void_[static_cast<std::size_t>(k)] - (was >= 0 ? void_[static_cast<std::size_t>(was)] : 0);
  };
  const double most_filled = was >= 0 ? 0 : kVoid;
  double save = 0;
  for (const std::size_t t : chain_) save += standing(t);
  own -= own_cost(last, goal_[last]);
  if (chain_.size() > 1) {
    const double rise = own + own_cost(last, was);
    if (rise - save < -kLess && close(was, rise)) return true;
  }
  for (std::size_t e = first_[last]; e < first_[last + 1]; ++e) {
    const std::int64_t k = choices_[e].column, rival = owner_[static_cast<std::size_t>(k)];
    const double rise = own + choices_[e].cost;
    if (rival < 0) {
      if (const double total = rise - filled(k); total - save < -kLess && close(k, total)) return true;
      continue;
    }
    const auto o = static_cast<std::size_t>(rival);
    if (turn_[o] != kNone || chain_.size() == kLongest || chains_ == kMostChains) continue;
    const double best = rise - (own_cost(o, k) - least_own_[o]) - most_filled;
    if (best - kHope * (save + standing(o)) > 0) continue;
    turn_[o] = chain_.size();
    chain_.push_back(o);
    ++chains_;
    const bool changed = extend(rise);
    chain_.pop_back();
    turn_[o] = kNone;
    if (changed) return true;
  }
  return false;
}

void Matching::change_places() {
  standing_.assign(n(), kUnknown);
  turn_.assign(n(), kNone);
  least_own_.assign(n(), 0);
  for (const Edge& e : choices_) least_own_[e.row] = std::min(least_own_[e.row], e.cost);
  auto change_from = [&](std::size_t t) {
    chain_.assign(1, t);
    chains_ = 0;
    turn_[t] = 0;
    const bool changed = extend(0);
    turn_[t] = kNone;
    return changed;
  };
  std::size_t left = 4 * n();  // each change gains, yet tiny gains shall not go on for ever
  bool any = true;
  for (int round = 0; round < kRounds && any; ++round) {
    any = false;
    for (std::size_t t = 0; t < n(); ++t)
      for (; left > 0 && change_from(t); --left) any = true;
  }
}

// --- places for those that have none ---

// What t pays at k while all others stay, but for `but`, which moves like it, and `before`, which has taken
// the place of t.
double Matching::paid(std::size_t t, std::int64_t k, std::size_t but, std::size_t before) const {
  double sum = own_cost(t, k);
  for (const std::size_t q : pairs_of_[t]) {
    const Pair& p = pairs_[q];
    const std::size_t o = other_of(p, t);
    const std::int64_t mine = o == but ? goal_[t] : k, theirs = o == before ? goal_[t] : goal_[o];
    sum += p.a == t ? pair_cost(p, mine, theirs) : pair_cost(p, theirs, mine);
  }
  return sum;
}

// The lost bead takes somebody's place, who takes the next one's, until there is one that nobody has. Chains
// are compared as if only the next in the chain moved along; whether the cheapest makes the sum less is
// worked out.
bool Matching::find_place(std::size_t lost) {
  struct Label {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t from = kNone;  // who takes the place
  };
  std::vector<Label> label(n());
  label[lost].cost = 0;
  Label last;  // of the chain, and where it goes
  std::int64_t place = kAlone;
  auto in_chain_of = [&](std::size_t t, std::size_t o) {
    while (t != kNone && t != o) t = label[t].from;
    return t == o;
  };
  std::vector<std::size_t> changed{lost}, next;
  std::vector<std::uint8_t> waits(n(), 0);
  for (int length = 0; length < kLongestChain && !changed.empty() && tries_ < kMostTries; ++length) {
    for (const std::size_t t : changed) waits[t] = 0;
    next.clear();
    for (const std::size_t t : changed) {
      const std::size_t from = label[t].from;
      const double now = paid(t, goal_[t], kNone, kNone);
      for (std::size_t e = first_[t]; e < first_[t + 1]; ++e) {
        const std::int64_t k = choices_[e].column, rival = owner_[static_cast<std::size_t>(k)];
        const std::size_t o = rival < 0 ? kNone : static_cast<std::size_t>(rival);
        if (o != kNone && in_chain_of(t, o)) continue;
        ++tries_;
        const double cost = label[t].cost + paid(t, k, o, from) - now;
        if (o == kNone) {
          if (cost < last.cost) {
            last = {cost, t};
            place = k;
          }
        } else if (cost < std::min(label[o].cost, kLost) - kLess) {
          label[o] = {cost, t};
          if (std::exchange(waits[o], std::uint8_t{1}) == 0) next.push_back(o);
        }
      }
    }
    changed.swap(next);
  }
  if (last.from == kNone) return false;
  const double before = total();
  const Goals old = goal_;
  Goals goals = goal_;
  for (std::size_t t = last.from; t != kNone; t = label[t].from) goals[t] = std::exchange(place, old[t]);
  adopt(goals);
  if (total() < before - kLess) return true;
  adopt(old);
  return false;
}

CollectiveMatching Matching::solve(const MatchKnowledge& known) {
  const Goals plain = exchange_messages(kPlain), tempered = exchange_messages(kTempered);
  adopt(plain);
  if (!known.guess.empty()) {
    Goals guessed(known.guess.begin(), known.guess.end());
    for (std::size_t t = 0; t < n(); ++t)
      if (std::isinf(own_cost(t, guessed[t]))) guessed[t] = kAlone;
    adopt(std::move(guessed));
  }
  fuse(tempered);
  for (std::size_t i = 0; i < kSeeds && n() > 0; ++i) {
    const std::size_t seed = order_[(2 * i + 1) * n() / (2 * kSeeds)];
    if (goal_[seed] >= 0) fuse(grown_from(seed));
  }
  change_places();
  const Goals unforced = goal_;
  // Where many have no place the frame is not understood, and to find each of them one takes long.
  const auto lost = static_cast<std::size_t>(std::count(goal_.begin(), goal_.end(), kAlone));
  if (known.nobody_lost && lost <= 1 + n() / kFew) {
    std::fill(void_.begin(), void_.end(), kLost);
    bool any = false;
    for (std::size_t t = 0; t < n(); ++t) any = (goal_[t] < 0 && find_place(t)) || any;
    if (any) change_places();
  }
  CollectiveMatching match{goal_, std::vector<double>(n(), std::numeric_limits<double>::infinity())};
  for (std::size_t t = 0; t < n(); ++t) {
    if (plain[t] != goal_[t] || tempered[t] != goal_[t] || unforced[t] != goal_[t]) match.margin[t] = 0;
    for (std::size_t e = first_[t]; goal_[t] >= 0 && e < first_[t + 1]; ++e)
      if (goal_[t] != choices_[e].column)
        match.margin[t] = std::min(match.margin[t], change(t, choices_[e].column));
  }
  return match;
}

}  // namespace

CollectiveMatching match_collectively(std::span<const PixelPoint> places,
                                      std::span<const PixelPoint> detections, std::span<const Edge> choices,
                                      double diameter_px, const MatchKnowledge& known) {
  return Matching(places, detections, choices, diameter_px, known.newcomers).solve(known);
}

}  // namespace twincell
