#pragma once
/// \file
/// Where along an axis an answer turns from no to yes, from runs that differ in their seeds.

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

/// How likely a mu is: ln(L(mu)/L_max), at most 0.
struct Likelihood {
  double mu = 0, log = 0;
};

/// 2 ln(L_max/L(mu)) from which on a mu is held to be excluded (onset.cpp says why not 3.841).
inline constexpr double kLikelihoodDrop = 6.0;

/// The onset mu and how far it is known.
struct Onset {
  std::optional<double> value;      ///< most likely mu; absent unless it lies within the range
  std::optional<double> low, high;  ///< 95 % interval; absent where it is open: a one-sided limit
  double level = 0.95;
  std::size_t n = 0, yes = 0;       ///< trials
  std::vector<Likelihood> profile;  ///< of mu on a grid over the range and half a range beyond either end

  /// "1.17 [1.15, 1.19], 9 of 20 runs"; "above 2.9, 0 of 12 runs up to 3".
  [[nodiscard]] std::string text() const;
};

/// P(yes at x) = 1/(1 + exp(-(x - mu)/w)) (logistic regression). mu by maximum likelihood, its interval by
/// the profile likelihood, {mu: 2 ln(L_max/L(mu)) < 6} with w free between width/8 and half the range; a
/// lower bound of w keeps the fit finite when all noes lie below all yeses, and its upper one is what makes a
/// single flip worth little: four or so agreeing runs on either side are needed before a side is closed. mu
/// is looked for up to half a range beyond either end; an interval that leaves the range is open on that
/// side. \param low, high range in which the trials lie \param width to which mu is to be known \pre low <
/// high, width > 0
Onset estimate_onset(const std::vector<Trial>& trials, double low, double high, double width);

/// `batch` places for the next runs: the (i + 1/2)/batch quantiles of the likelihood of mu, so that runs go
/// where the onset may still be; rounded to multiples of width/2 from `low`, within the range.
std::vector<double> next_places(const Onset& onset, double low, double high, double width, int batch);

/// How much worse it fits that `upper` lies no higher than `lower`: 2 ln(L_max/L), L the largest joint
/// likelihood with mu_upper <= mu_lower (likelihood ratio of two independent onsets). 0 if that fits best;
/// compare with kLikelihoodDrop. This decides where two intervals overlap a little. \pre both have a profile
double evidence_above(const Onset& upper, const Onset& lower);

/// Whether nothing is left to ask: the interval is closed and no wider than `width`, or the onset is known to
/// lie less than `width` from an end of the range or beyond it.
bool settled(const Onset& onset, double low, double high, double width);

}  // namespace twincell::sweep
