// The evidence that one onset is above another, 2 ln(L/L_opposite), against closed forms. Half or twice the
// evidence fails these tests.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "sweep/onset.hpp"

namespace twincell::sweep::onset_evidence_test {
namespace {

/// An onset whose likelihood is a normal law.
Onset normal(double mean, double sigma) {
  Onset onset;
  onset.n = 1;
  for (int k = 0; k <= 4000; ++k) {
    const double mu = 1 + 0.001 * k;
    onset.profile.push_back({mu, -0.5 * std::pow((mu - mean) / sigma, 2)});
  }
  return onset;
}

TEST(OnsetEvidence, OfTwoNormalLikelihoodsIsThatOfTheirDifference) {
  // The constrained maximum of two normal laws gives (m_1 - m_2)^2/(s_1^2 + s_2^2), the square of the
  // standardized difference.
  for (const auto& [upper, lower, s_1, s_2] :
       {std::array{3.0, 2.5, 0.1, 0.2}, {3.0, 2.0, 0.3, 0.05}, {2.6, 2.5, 0.2, 0.2}}) {
    const double expected = (upper - lower) * (upper - lower) / (s_1 * s_1 + s_2 * s_2);
    EXPECT_NEAR(evidence_above(normal(upper, s_1), normal(lower, s_2)), expected, 0.02 * expected);
    // The opposite order fits best, so nothing speaks for the stated one.
    EXPECT_NEAR(evidence_above(normal(lower, s_2), normal(upper, s_1)), 0, 1e-12);
  }
}

TEST(OnsetEvidence, FromRunsAtOnePlaceIsThatOfFairCoins) {
  // n runs of one kind say yes at x, n of the other kind say no. If the second onset is not above the first,
  // the answers of one kind have probability 1/2 at best: L/L_opposite = 2^n. The finite widths of the
  // logistic law can only add to it.
  for (const int n : {4, 8, 16}) {
    const std::vector<Trial> yes(static_cast<std::size_t>(n), Trial{3, true}),
        no(static_cast<std::size_t>(n), Trial{3, false});
    const double expected = 2 * n * std::numbers::ln2;
    const double found = evidence_above(estimate_onset(no, 1, 5, 0.2), estimate_onset(yes, 1, 5, 0.2));
    EXPECT_GT(found, expected * (1 - 1e-9));
    EXPECT_LT(found, expected * 1.1);
  }
}

TEST(OnsetEvidence, GrowsInProportionToTheRuns) {
  const auto step_at = [](double mu, int n) {
    std::vector<Trial> trials;
    for (int k = 0; k < n; ++k)
      for (const double away : {0.1, 0.3}) {
        trials.push_back({mu - away, false});
        trials.push_back({mu + away, true});
      }
    return estimate_onset(trials, 1, 5, 0.2);
  };
  const double few = evidence_above(step_at(3, 2), step_at(2, 2));
  EXPECT_NEAR(evidence_above(step_at(3, 6), step_at(2, 6)), 3 * few, 0.01 * few);
}

}  // namespace
}  // namespace twincell::sweep::onset_evidence_test
