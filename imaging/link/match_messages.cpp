#include "imaging/link/match_messages.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace twincell::imaging {

MatchMessages::MatchMessages(const MatchProblem& problem) : problem_(problem) {
  std::size_t messages = 0;
  for (const MatchProblem::Pair& p : problem_.pairs) {
    Route route{};
    const std::size_t of_a = problem_.first[p.a + 1] - problem_.first[p.a],
                      of_b = problem_.first[p.b + 1] - problem_.first[p.b];
    route.to_a = messages;
    route.to_b = messages + of_a + 1;
    messages += of_a + of_b + 2;
    route.first = compatible_.size();
    const PixelPoint between = problem_.places[p.b] - problem_.places[p.a];
    for (std::size_t k = 0; k < of_a; ++k) {
      const std::uint32_t to_a = problem_.choices[problem_.first[p.a] + k].column;
      const PixelPoint same_step = problem_.detections[to_a] + between;
      for (std::size_t l = 0; l < of_b; ++l) {
        const std::uint32_t to_b = problem_.choices[problem_.first[p.b] + l].column;
        const double r2 = square(problem_.detections[to_b] - same_step) / (problem_.d * problem_.d);
        if (to_a == to_b || r2 >= kMatchCosts.step_difference_cap * kMatchCosts.step_difference_cap) continue;
        compatible_.push_back({static_cast<std::uint16_t>(k), static_cast<std::uint16_t>(l),
                               static_cast<float>(p.weight * MatchProblem::step_difference_cost(r2))});
      }
    }
    route.last = compatible_.size();
    routes_.push_back(route);
  }
  message_.resize(messages);
  belief_.resize(problem_.choices.size() + problem_.n());
  exclusivity_.resize(problem_.choices.size());
}

void MatchMessages::gather_beliefs(std::size_t t) {
  const std::size_t m = problem_.first[t + 1] - problem_.first[t];
  float* belief = &belief_[problem_.first[t] + t];
  for (std::size_t k = 0; k < m; ++k)
    belief[k] = static_cast<float>(problem_.choices[problem_.first[t] + k].cost) +
                exclusivity_[problem_.first[t] + k];
  belief[m] = 0;
  for (const std::size_t q : problem_.pairs_of[t]) {
    const float* in = &message_[problem_.pairs[q].a == t ? routes_[q].to_a : routes_[q].to_b];
    for (std::size_t k = 0; k <= m; ++k) belief[k] += in[k];
  }
}

void MatchMessages::send_message(std::size_t from, std::size_t pair, float share) {
  const MatchProblem::Pair& p = problem_.pairs[pair];
  const Route& route = routes_[pair];
  const bool forth = p.a == from;
  const std::size_t to = forth ? p.b : p.a;
  const std::size_t m = problem_.first[from + 1] - problem_.first[from],
                    m_to = problem_.first[to + 1] - problem_.first[to];
  const float* belief = &belief_[problem_.first[from] + from];
  const float* in = &message_[forth ? route.to_a : route.to_b];
  float* out = &message_[forth ? route.to_b : route.to_a];
  const auto far = static_cast<float>(p.weight * MatchProblem::capped_step_difference_cost());
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k <= m; ++k) least = std::min(least, share * belief[k] - in[k]);
  std::fill(out, out + m_to + 1, least + far);
  for (std::size_t q = route.first; q < route.last; ++q) {
    const CompatibleChoices& both = compatible_[q];
    const std::size_t mine = forth ? both.of_a : both.of_b, theirs = forth ? both.of_b : both.of_a;
    out[theirs] = std::min(out[theirs], share * belief[mine] - in[mine] + both.cost);
  }
  const float low = *std::min_element(out, out + m_to + 1);
  for (std::size_t k = 0; k <= m_to; ++k) out[k] -= low;
}

// Exclusivity messages: each detection sends each bead the extra cost of giving up this detection, which is
// the gain of the best rival or the cost of leaving the detection unused. Returns true if no bead has changed
// its best choice.
bool MatchMessages::send_exclusivity_messages() {
  struct Rivals {
    float best, second;
    std::size_t who = std::numeric_limits<std::size_t>::max();
  };
  std::vector<Rivals> rivals;
  for (const double empty : problem_.unused_cost)
    rivals.push_back({static_cast<float>(empty), static_cast<float>(empty)});
  bool same = true;
  for (std::size_t t = 0; t < problem_.n(); ++t) {
    gather_beliefs(t);
    const std::size_t m = problem_.first[t + 1] - problem_.first[t];
    const float* belief = &belief_[problem_.first[t] + t];
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
      const float preference = belief[k] - exclusivity_[problem_.first[t] + k] - (k == which ? second : best);
      Rivals& r = rivals[problem_.choices[problem_.first[t] + k].column];
      if (preference < r.best) {
        r.second = std::exchange(r.best, preference);
        r.who = t;
      } else {
        r.second = std::min(r.second, preference);
      }
    }
  }
  for (std::size_t t = 0; t < problem_.n(); ++t)
    for (std::size_t e = problem_.first[t]; e < problem_.first[t + 1]; ++e) {
      const Rivals& r = rivals[problem_.choices[e].column];
      exclusivity_[e] =
          0.5F * exclusivity_[e] - 0.5F * (r.who == t ? r.second : r.best);  // damped against oscillation
    }
  return same;
}

MatchSolution MatchMessages::pass(double share) {
  std::fill(message_.begin(), message_.end(), 0.0F);
  std::fill(exclusivity_.begin(), exclusivity_.end(), 0.0F);
  best_choice_.assign(problem_.n(), 0);
  // Sweeps: alternately downwards and upwards until the best choices are stable.
  int stable = 0;
  for (int sweep = 0; sweep < kMatchCosts.max_sweeps && stable < kMatchCosts.stable_sweeps; ++sweep) {
    const bool downwards = sweep % 2 == 0;
    for (std::size_t i = 0; i < problem_.n(); ++i) {
      const std::size_t t = problem_.order[downwards ? i : problem_.n() - 1 - i];
      gather_beliefs(t);
      for (const std::size_t q : problem_.pairs_of[t])
        if ((problem_.rank[MatchProblem::other_of(problem_.pairs[q], t)] > problem_.rank[t]) == downwards)
          send_message(t, q, static_cast<float>(share));
    }
    stable = send_exclusivity_messages() ? stable + 1 : 0;
  }
  // Rounding: the beliefs become costs of an assignment, which resolves the remaining conflicts.
  std::vector<Edge> edges(problem_.choices.begin(), problem_.choices.end());
  for (std::size_t t = 0; t < problem_.n(); ++t) {
    gather_beliefs(t);
    const float* belief = &belief_[problem_.first[t] + t];
    const std::size_t m = problem_.first[t + 1] - problem_.first[t];
    for (std::size_t k = 0; k < m; ++k)
      edges[problem_.first[t] + k].cost = static_cast<double>(belief[k] - belief[m]);
  }
  return assign(problem_.n(), problem_.detections.size(), edges).column_of_row;
}

}  // namespace twincell::imaging
