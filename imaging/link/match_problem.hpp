#pragma once
/// \file
/// Input of a collective matching (collective_matching.hpp): beads, detections, neighbours, and the
/// costs of single beads and of pairs.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"
#include "imaging/link/assignment.hpp"
#include "imaging/link/point_grid.hpp"

namespace twincell::imaging {

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
  /// It runs if at most 1 + n / beads_per_unassigned beads are unassigned.
  std::size_t beads_per_unassigned = 20;
  int max_search_length = 40;              ///< beads in its longest chain
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
inline constexpr MatchCosts kMatchCosts;

/// Stands for no bead where a bead is named by its number.
inline constexpr std::size_t kNoBead = std::numeric_limits<std::size_t>::max();

/// A matching: the detection of each bead; Assignment::kAlone: unassigned.
using MatchSolution = std::vector<std::int64_t>;

/// Beads, detections and costs of one frame.
struct MatchProblem {
  /// Two neighbours.
  struct Pair {
    std::size_t a, b;
    double weight;
  };

  /// Finds the neighbours. The arguments are those of match_collectively(); places, detections and choices
  /// outlive this.
  /// \param d bead diameter, px
  MatchProblem(std::span<const PixelPoint> places, std::span<const PixelPoint> detections,
               std::span<const Edge> choices, double d, std::span<const std::uint8_t> newcomers);

  [[nodiscard]] std::size_t n() const { return places.size(); }  ///< beads
  /// Displacement of bead t to detection k, px.
  /// \pre k >= 0
  [[nodiscard]] PixelPoint step(std::size_t t, std::int64_t k) const {
    return detections[static_cast<std::size_t>(k)] - places[t];
  }
  /// The other bead of a pair.
  [[nodiscard]] static std::size_t other_of(const Pair& p, std::size_t t) { return p.a == t ? p.b : p.a; }

  /// 2 ln(1 + r^2/w^2), log-odds, of a difference of steps.
  /// \param r2 r^2, d^2
  [[nodiscard]] static double step_difference_cost(double r2) {
    return kMatchCosts.step_difference_exponent *
           std::log(1 + r2 / (kMatchCosts.step_difference_width * kMatchCosts.step_difference_width));
  }
  /// Its largest value, log-odds, which also applies if one of the two beads is unassigned.
  [[nodiscard]] static double capped_step_difference_cost() {
    static const double cost =
        step_difference_cost(kMatchCosts.step_difference_cap * kMatchCosts.step_difference_cap);
    return cost;
  }
  /// u_t(k), log-odds; 0 for k < 0 (unassigned), infinity if k is not a choice of t.
  [[nodiscard]] double own_cost(std::size_t t, std::int64_t k) const {
    if (k < 0) return 0;
    for (std::size_t e = first[t]; e < first[t + 1]; ++e)
      if (choices[e].column == k) return choices[e].cost;
    return std::numeric_limits<double>::infinity();
  }
  /// Cost, log-odds, of two neighbours at detections ka and kb, overlap() included.
  [[nodiscard]] double pair_cost(const Pair& p, std::int64_t ka, std::int64_t kb) const {
    if (ka < 0 || kb < 0) return p.weight * capped_step_difference_cost();
    const PixelPoint before = places[p.b] - places[p.a];
    const PixelPoint change =
        detections[static_cast<std::size_t>(kb)] - detections[static_cast<std::size_t>(ka)] - before;
    const double c2 = square(change);
    const double cost =
        p.weight * (c2 < kMatchCosts.step_difference_cap * kMatchCosts.step_difference_cap * d * d
                        ? step_difference_cost(c2 / (d * d))
                        : capped_step_difference_cost());
    return cost + overlap(before, change);
  }
  /// Cost, log-odds, of straight paths on which two discs of one layer would pass through each other.
  /// \param before vector from one bead to the other in the previous frame, px
  /// \param change its change in the step, px
  [[nodiscard]] double overlap(PixelPoint before, PixelPoint change) const {
    const double c2 = square(change), dot = -(before.x_px * change.x_px + before.y_px * change.y_px);
    if (dot <= 0 || dot >= c2) return 0;  // closest at the start or the end, which are observed positions
    const double r2 = (square(before) - dot * dot / c2) / (d * d);
    if (r2 >= kMatchCosts.overlap_onset * kMatchCosts.overlap_onset) return 0;
    return kMatchCosts.overlap_cost *
           std::min(1.0, (kMatchCosts.overlap_onset - std::sqrt(std::max(r2, 0.0))) /
                             (kMatchCosts.overlap_onset - kMatchCosts.full_overlap));
  }
  /// As above, for two beads at detections ka and kb; 0 if one is unassigned.
  [[nodiscard]] double overlap(std::size_t a, std::int64_t ka, std::size_t b, std::int64_t kb) const {
    if (ka < 0 || kb < 0) return 0;
    return overlap(places[b] - places[a], step(b, kb) - step(a, ka));
  }

  /// Sum of all costs of a matching, log-odds.
  /// \param owner bead of each detection, < 0: unused
  [[nodiscard]] double total(const MatchSolution& matching, const std::vector<std::int64_t>& owner) const;

  std::span<const PixelPoint> places, detections;  ///< px
  std::span<const Edge> choices;
  double d;                              ///< bead diameter, px
  std::vector<std::size_t> first;        ///< first choice of each bead, and behind the last
  std::vector<std::size_t> order, rank;  ///< beads sorted from the top downwards
  std::vector<Pair> pairs;
  /// Of each bead: its pairs, and farther beads that it might pass through.
  std::vector<std::vector<std::size_t>> pairs_of, far_of;
  std::vector<double> unused_cost;  ///< of each detection

 private:
  void find_neighbours();
};

}  // namespace twincell::imaging
