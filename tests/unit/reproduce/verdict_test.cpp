// One rule compares a measured number with a target: every case, and both edges of every case.

#include "reproduce/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace twincell::reproduce::verdict_test {
namespace {

constexpr double kTiny = 1e-12;

/// The verdict on an interval for the target [6, 8].
Verdict of(std::optional<double> low, std::optional<double> high) {
  return judge({7, low, high}, 6, 8);
}

TEST(Verdict, AnIntervalInsideTheTargetPasses) {
  EXPECT_EQ(of(6.5, 7.5), Verdict::pass);
  // Both ends of the target belong to it.
  EXPECT_EQ(of(6, 8), Verdict::pass);
  EXPECT_NE(of(6 - kTiny, 8), Verdict::pass);
  EXPECT_NE(of(6, 8 + kTiny), Verdict::pass);
}

TEST(Verdict, AnIntervalOutsideTheTargetFails) {
  EXPECT_EQ(of(8.5, 9), Verdict::fail);
  EXPECT_EQ(of(4, 5.5), Verdict::fail);
  EXPECT_EQ(of(8 + kTiny, 8.5), Verdict::fail);
  EXPECT_EQ(of(5.5, 6 - kTiny), Verdict::fail);
  // A common end is an overlap.
  EXPECT_EQ(of(8, 8.5), Verdict::consistent);
  EXPECT_EQ(of(5.5, 6), Verdict::consistent);
}

TEST(Verdict, AnOverlapIsConsistentIfTheIntervalIsNarrowerThanTheTarget) {
  EXPECT_EQ(of(7, 8.9), Verdict::consistent);
  EXPECT_EQ(of(5.1, 7), Verdict::consistent);
  // As wide as the target, or wider: the measurement is too coarse.
  EXPECT_EQ(of(7, 9), Verdict::inconclusive);
  EXPECT_EQ(of(7, 9 - 1e-9), Verdict::consistent);
  EXPECT_EQ(of(5, 9), Verdict::inconclusive);
}

TEST(Verdict, TheValueInsideTheIntervalDoesNotCount) {
  EXPECT_EQ(judge({7, 4, 20}, 6, 8), Verdict::inconclusive);
  EXPECT_EQ(judge({9, 7, 8.9}, 6, 8), Verdict::consistent);
}

TEST(Verdict, AnOpenEndReachesToInfinity) {
  EXPECT_EQ(of(9, {}), Verdict::fail);
  EXPECT_EQ(of({}, 5), Verdict::fail);
  EXPECT_EQ(of(7, {}), Verdict::inconclusive);
  EXPECT_EQ(of({}, 7), Verdict::inconclusive);
  EXPECT_EQ(of({}, {}), Verdict::inconclusive);
  EXPECT_EQ(of(std::nan(""), std::nan("")), Verdict::inconclusive);
}

TEST(Verdict, ATargetWithoutAnEndIsNeverConsistent) {
  EXPECT_EQ(judge({7, 6.5, 7.5}, 6, kUnbounded), Verdict::pass);
  EXPECT_EQ(judge({7, 6.5, 7.5}, 7, kUnbounded), Verdict::inconclusive);
  EXPECT_EQ(judge({7, 6.5, 7.5}, 8, kUnbounded), Verdict::fail);
  EXPECT_EQ(judge({7, 6.5, {}}, 6, kUnbounded), Verdict::pass);
  EXPECT_EQ(judge({7, {}, 7.5}, -kUnbounded, 7.5), Verdict::pass);
}

TEST(Verdict, AnExactNumberPassesOrFails) {
  EXPECT_EQ(judge(exact(7), 7, 7), Verdict::pass);
  EXPECT_EQ(judge(exact(7), 6, 7), Verdict::pass);
  EXPECT_EQ(judge(exact(std::nextafter(7, 8)), 6, 7), Verdict::fail);
  EXPECT_EQ(holds(true), Verdict::pass);
  EXPECT_EQ(holds(false), Verdict::fail);
}

TEST(Verdict, OneNumberIsAboveAnotherIfTheirIntervalsAreSeparate) {
  const Estimate seven{7, 6.5, 7.5};
  EXPECT_EQ(above(seven, {5, 4, 6}), Verdict::pass);
  EXPECT_EQ(above({5, 4, 6}, seven), Verdict::fail);
  EXPECT_EQ(above(seven, {6, 5, 7}), Verdict::inconclusive);
  EXPECT_EQ(above(seven, {6, 5, 6.5}), Verdict::inconclusive);  // a common end
  EXPECT_EQ(above(seven, {6, 5, 6.5 - kTiny}), Verdict::pass);
  EXPECT_EQ(above(exact(0), exact(0)), Verdict::fail);  // two exact equal numbers are not above each other
  EXPECT_EQ(differ(seven, {5, 4, 6}), Verdict::pass);
  EXPECT_EQ(differ({5, 4, 6}, seven), Verdict::pass);
  EXPECT_EQ(differ(seven, {6, 5, 7}), Verdict::inconclusive);
}

TEST(Verdict, EqualityNeedsATolerance) {
  EXPECT_EQ(agree({7, 6.9, 7.1}, {7.2, 7.1, 7.3}, 0.4), Verdict::pass);
  EXPECT_EQ(agree({7, 6.9, 7.1}, {7.2, 7.1, 7.3}, 0.3), Verdict::consistent);
  EXPECT_EQ(agree({7, 6.9, 7.1}, {8, 7.9, 8.1}, 0.3), Verdict::fail);
  EXPECT_EQ(agree({7, 6, 8}, {7, 6, 8}, 0.3), Verdict::inconclusive);
  EXPECT_EQ(agree({7, 6.9, {}}, {7, 6.9, 7.1}, 0.3), Verdict::inconclusive);
}

TEST(Verdict, AStatementOfSeveralPartsIsAsGoodAsItsWorstPart) {
  using enum Verdict;
  EXPECT_EQ(all_of({pass, pass}), pass);
  EXPECT_EQ(all_of({pass, consistent}), consistent);
  EXPECT_EQ(all_of({consistent, inconclusive, pass}), inconclusive);
  EXPECT_EQ(all_of({inconclusive, fail, pass}), fail);
  EXPECT_EQ(all_of({}), absent);
  // A statement about every case is not met by one of them.
  EXPECT_EQ(all_of({pass, pass}, 2), pass);
  EXPECT_EQ(all_of({pass}, 2), inconclusive);
  EXPECT_EQ(all_of({consistent}, 2), inconclusive);
  EXPECT_EQ(all_of({fail}, 2), fail);
  EXPECT_EQ(all_of({}, 2), absent);
  EXPECT_EQ(best_of(fail, inconclusive), inconclusive);
  EXPECT_EQ(best_of(consistent, inconclusive), consistent);
  EXPECT_EQ(best_of(consistent, pass), pass);
  EXPECT_EQ(best_of(fail, fail), fail);
}

TEST(Verdict, EveryVerdictHasItsWord) {
  EXPECT_EQ(word_of(Verdict::consistent), "consistent");
  EXPECT_EQ(kVerdicts.size(), 5U);
}

sweep::Onset onset(std::optional<double> value, std::optional<double> low, std::optional<double> high) {
  sweep::Onset o;
  o.value = value;
  o.low = low;
  o.high = high;
  o.n = 10;
  return o;
}

TEST(Verdict, AnOnsetIsJudgedByItsInterval) {
  EXPECT_EQ(judge(estimate_of(onset(1.2, 1.15, 1.25)), 1.1, 1.35), Verdict::pass);
  EXPECT_EQ(judge(estimate_of(onset(1.4, 1.3, 1.5)), 1.1, 1.35), Verdict::consistent);
  EXPECT_EQ(judge(estimate_of(onset({}, 1.4, {})), 1.1, 1.35), Verdict::fail);
  EXPECT_EQ(judge(estimate_of(onset({}, 1.2, {})), 1.1, 1.35), Verdict::inconclusive);
}

/// The onset of a bed whose answer changes at mu, from `n` runs at each of two points on either side.
sweep::Onset step_at(double mu, int n) {
  std::vector<sweep::Trial> trials;
  for (int k = 0; k < n; ++k)
    for (const double away : {0.1, 0.3}) {
      trials.push_back({mu - away, false});
      trials.push_back({mu + away, true});
    }
  return estimate_onset(trials, 1, 5, 0.2);
}

TEST(Verdict, OneOnsetIsAboveAnotherWhenTheOppositeIsExcluded) {
  EXPECT_EQ(above(step_at(3, 4), step_at(2, 4)), Verdict::pass);
  EXPECT_EQ(above(step_at(2, 4), step_at(3, 4)), Verdict::fail);
  EXPECT_EQ(above(step_at(2.05, 4), step_at(2, 4)), Verdict::inconclusive);
  EXPECT_EQ(above(step_at(2.3, 1), step_at(2, 1)), Verdict::inconclusive);
  EXPECT_EQ(above(step_at(3, 4), sweep::Onset{}), Verdict::absent);
  // An onset above the range is greater than one inside it.
  const std::vector<sweep::Trial> never(10, sweep::Trial{4.9, false});
  EXPECT_EQ(above(estimate_onset(never, 1, 5, 0.2), step_at(2, 4)), Verdict::pass);
}

TEST(Trend, IsThatOfTheEndsUnlessTheSeriesClearlyTurns) {
  const auto series = [](const std::vector<double>& values, double half) {
    std::vector<Estimate> all;
    for (const double v : values) all.push_back({v, v - half, v + half});
    return all;
  };
  EXPECT_EQ(trend_of(series({1, 2, 3}, 0.4), true).verdict, Verdict::pass);
  EXPECT_EQ(trend_of(series({1, 2, 3}, 0.4), false).verdict, Verdict::fail);
  EXPECT_EQ(trend_of(series({1, 2, 3}, 1.1), true).verdict, Verdict::inconclusive);
  EXPECT_EQ(trend_of(series({1}, 0.1), true).verdict, Verdict::absent);
  // From 3 to 2.4 with half widths of h each, intervals wider by half are separate below h = 0.2.
  EXPECT_EQ(trend_of(series({1, 3, 2.4}, 0.21), true).verdict, Verdict::pass);
  const Trend turned = trend_of(series({1, 3, 2.4}, 0.19), true);
  EXPECT_EQ(turned.verdict, Verdict::fail);
  ASSERT_TRUE(turned.against);
  EXPECT_EQ(*turned.against, std::pair(std::size_t{1}, std::size_t{2}));
  // The measured heights of Fig. 16, 2D rough, z = 2.5 d: a fall over all that first rises.
  const std::vector<Estimate> bump = {
      {0.4649, 0.4371, 0.4927}, {0.575, 0.556, 0.594}, {0.321, 0.3114, 0.3306}};
  EXPECT_EQ(trend_of(bump, false).verdict, Verdict::fail);
  // Without intervals only the ends count.
  EXPECT_EQ(trend_of({{1, {}, {}}, {3, {}, {}}, {2, {}, {}}}, true).verdict, Verdict::inconclusive);
}

}  // namespace
}  // namespace twincell::reproduce::verdict_test
