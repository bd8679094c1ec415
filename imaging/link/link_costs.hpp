#pragma once
/// \file
/// The numbers of the linker, and the cost of a prediction error.

#include <cmath>
#include <cstddef>

namespace twincell::imaging {

/// The numbers of the linker. d: bead diameter. Costs are log-odds, natural logarithm. Where no source is
/// given, none is recorded.
struct LinkCosts {
  // Lookup and prediction.
  double settle_reach = 0.25;    ///< d; a detection this close has no rival, because discs do not overlap
  double lookup_reach = 0.5;     ///< d; reach of the lookup
  double rival_ratio = 2;        ///< a second candidate this many times farther away is not a rival
  double neighbour_reach = 2.1;  ///< d; distance of neighbours whose steps are compared
  double good_fit = 0.95;        ///< fit, 0 .. 1, above which no further rule is tried
  double open_fraction = 0.03;   ///< of all tracks; with more open ones, the settled ones are checked again
  double agreeing_steps = 0.3;   ///< d; difference between neighbours' steps that agree
  double agreeing_predictions = 0.1;  ///< d; difference between predictions that agree
  double preference_margin = 0.05;    ///< d; a detection must be closer by this much to be preferred
  /// d; standard deviation of the common shift about that of the centre of mass.
  double common_shift_sigma = 0.5;
  std::size_t sample_tracks = 200;  ///< tracks on which the rules are tried
  int neighbour_rounds = 12;        ///< rounds of following neighbours

  // Assignment: exchange of two crossing links, by the closest approach of the centres.
  double passing_through = 0.6;    ///< d; below, one disc passes through the other
  double passing_clear = 0.8;      ///< d; above, it does not
  double exchange_cost_limit = 8;  ///< log-odds; most expensive exchange that is made to avoid it
  std::size_t max_edges = 16;      ///< choices of one track in the assignment

  // Collective matching: when, and among which choices.
  double touching_reach = 1.3;  ///< d; distance of touching neighbours
  /// d; difference of touching neighbours' steps beyond which the frame is rematched.
  double separation = 0.8;
  double matching_reach = 1.9;        ///< d; reach about an expected position
  std::size_t max_choices = 40;       ///< choices of one track
  std::size_t max_mean_choices = 25;  ///< mean choices of a track; with more, the matching is not attempted
  double least_outward_step = 0.1;    ///< d; smallest step of a bead that leaves an open picture
  double entry_margin = 1;            ///< d; distance from the border within which beads come into sight
  double left_over_reach = 8;  ///< d; largest distance between the last tracks and the detections left over

  // Densities of prediction errors.
  double prediction_width = 0.12;   ///< d; core width for the expected position, see `cost`
  double ballistic_width = 0.02;    ///< d; core width for free flight
  double ballistic_exponent = 2.5;  ///< its exponent
  // For a path with one collision. Width and exponent were fitted to the links of simulated convecting cells,
  // by their odds against the other choices. With the fitted cost, -2, fewer wrong links are removed than
  // with this one.
  double collision_width = 0.02;     ///< d; core width
  double collision_exponent = 1.25;  ///< its exponent
  double collision_cost = -4;        ///< log-odds; of a path with one collision

  // Costs of the explanations of a detection, and of having none.
  double ballistic_cost = 2;             ///< log-odds; being in free flight
  double any_position_cost = 6;          ///< log-odds; being anywhere within reach
  double type_change_cost = 3;           ///< log-odds; changing from tracer to bead or back
  double no_match_cost = 16;             ///< log-odds; having no detection
  double unconfirmed_no_match_cost = 0;  ///< log-odds; the same for a track seen in one frame only
  double leaving_cost = 0;  ///< log-odds; the same for a bead that leaves an open picture or is missing in it
};
inline constexpr LinkCosts kLinkCosts;

/// Cost of a link with squared prediction error r2. The errors have a narrow core and, from collisions
/// between two frames, a long tail: a density (1 + r^2/w^2)^(-3/2) / w^2 in the plane. The cost is its
/// negative logarithm, so that differences of costs are log-odds. With squared distances, the usual cost, one
/// large error would outweigh many small ones.
inline double cost(double r2, double width) {
  return 1.5 * std::log1p(r2 / (width * width)) + 2 * std::log(width);
}

}  // namespace twincell::imaging
