// When a target is met, missed, or left open by an interval.

#include <gtest/gtest.h>

#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {
namespace {

sweep::Onset onset(std::optional<double> value, std::optional<double> low, std::optional<double> high) {
  sweep::Onset o;
  o.value = value;
  o.low = low;
  o.high = high;
  o.n = 10;
  return o;
}

TEST(Targets, AValueInsideIsMetAnIntervalOutsideIsMissed) {
  EXPECT_EQ(within(onset(1.2, 1.15, 1.25), 1.1, 1.35), Fate::met);
  EXPECT_EQ(within(onset(1.5, 1.4, 1.6), 1.1, 1.35), Fate::missed);
  EXPECT_EQ(within(onset(1.0, 0.9, 1.05), 1.1, 1.35), Fate::missed);
  EXPECT_EQ(within(onset(1.4, 1.3, 1.5), 1.1, 1.35), Fate::open);
  EXPECT_EQ(within(onset({}, 1.4, {}), 1.1, 1.35), Fate::missed);
  EXPECT_EQ(within(onset({}, 1.2, {}), 1.1, 1.35), Fate::open);
  EXPECT_EQ(within(onset({}, {}, {}), 1.1, 1.35), Fate::open);
  EXPECT_EQ(within(sweep::Onset{}, 1.1, 1.35), Fate::absent);
}

/// Of a bed that flips at mu: `n` runs at each of two places on either side.
sweep::Onset step_at(double mu, int n) {
  std::vector<sweep::Trial> trials;
  for (int k = 0; k < n; ++k)
    for (const double away : {0.1, 0.3}) {
      trials.push_back({mu - away, false});
      trials.push_back({mu + away, true});
    }
  return estimate_onset(trials, 1, 5, 0.2);
}

TEST(Targets, OneOnsetIsAboveAnotherWhenTheOppositeIsExcluded) {
  EXPECT_EQ(above(step_at(3, 4), step_at(2, 4)), Fate::met);
  EXPECT_EQ(above(step_at(2, 4), step_at(3, 4)), Fate::missed);
  EXPECT_EQ(above(step_at(2.05, 4), step_at(2, 4)), Fate::open);
  EXPECT_EQ(above(step_at(2.3, 1), step_at(2, 1)), Fate::open);
  EXPECT_EQ(above(step_at(3, 4), sweep::Onset{}), Fate::absent);
  // An onset beyond the range is above one inside it.
  const std::vector<sweep::Trial> never(10, sweep::Trial{4.9, false});
  EXPECT_EQ(above(estimate_onset(never, 1, 5, 0.2), step_at(2, 4)), Fate::met);
}

TEST(Targets, EvidenceIsZeroForWhatFitsBestAndGrowsWithRuns) {
  EXPECT_NEAR(evidence_above(step_at(2, 4), step_at(3, 4)), 0, 1e-12);
  EXPECT_GT(evidence_above(step_at(3, 4), step_at(2, 4)), evidence_above(step_at(3, 2), step_at(2, 2)));
}

}  // namespace
}  // namespace twincell::reproduce
