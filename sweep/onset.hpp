#pragma once
/// \file
/// Onset along an axis, where the answer changes from no to yes, from runs with different seeds.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace twincell::sweep {

/// One run: at x the answer was yes or no.
struct Trial {
  double x = 0;
  bool yes = false;
};

/// Log-likelihood ratio of an onset mu: ln(L(mu)/L_max), at most 0.
struct Likelihood {
  double mu = 0, log = 0;
};

/// Value of 2 ln(L_max/L(mu)) from which a mu is excluded at 95 % (onset.cpp explains why it is not 3.841).
inline constexpr double kLikelihoodDrop = 6.0;

/// Estimate of the onset mu with its interval.
struct Onset {
  std::optional<double> value;      ///< most likely mu; absent outside the range or if all answers agree
  std::optional<double> low, high;  ///< 95 % interval; an absent end is open (one-sided limit)
  double level = 0.95;
  std::size_t n = 0, yes = 0;  ///< number of trials, and of those with the answer yes
  bool falls = false;          ///< the answers change from yes to no instead: value, low and high are absent
  std::vector<Likelihood> profile;  ///< on a grid over the range and half a range beyond either end

  /// "1.17 [1.15, 1.19], yes in 9 of 20 runs"; "above 2.9, yes in 0 of 12 runs".
  [[nodiscard]] std::string text() const;
};

/// Logistic regression P(yes at x) = 1/(1 + exp(-(x - mu)/w)). mu is the maximum-likelihood value; its
/// interval comes from the profile likelihood, {mu: 2 ln(L_max/L(mu)) < 6}, with w free between width/8 and
/// half the range. The lower bound of w keeps the fit finite if all answers no are below all answers yes. The
/// upper bound gives a single change of answer little weight: about four agreeing runs on either side are
/// needed before that side of the interval is closed. mu is searched up to half a range beyond either end; an
/// interval that extends beyond the range is open on that side. The same law that falls from yes to no is
/// fitted too; if it is more likely by kLikelihoodDrop, the answers fall, and there is no onset.
/// \param low, high range of the trials
/// \param width wanted width of the interval
/// \pre low < high, width > 0
Onset estimate_onset(const std::vector<Trial>& trials, double low, double high, double width);

/// Positions of the next `batch` runs: the (i + 1/2)/batch quantiles of the likelihood of mu, so that runs
/// are placed where the onset may still be. They are rounded to multiples of width/2 from `low`, within the
/// range.
std::vector<double> next_places(const Onset& onset, double low, double high, double width, int batch);

/// Likelihood-ratio statistic against the hypothesis that `upper` is not above `lower`: 2 ln(L_max/L), where
/// L is the largest joint likelihood of two independent onsets with mu_upper <= mu_lower. It is 0 if that
/// hypothesis fits best. A value above kLikelihoodDrop excludes it, also where the two intervals overlap
/// slightly.
/// \pre both have a profile
double evidence_above(const Onset& upper, const Onset& lower);

/// Whether the search is finished: the interval is closed and not wider than `width`, or a one-sided limit
/// places the onset less than `width` from an end of the range or beyond it, or the answers fall.
bool settled(const Onset& onset, double low, double high, double width);

}  // namespace twincell::sweep
