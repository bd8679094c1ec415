// Onsets drawn from a known law are recovered, with intervals that have the stated coverage.

#include "sweep/onset.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace twincell::sweep::onset_test {
namespace {

/// A search as a sweep performs it, with answers drawn from P(yes at x) = 1/(1 + exp(-(x - mu)/w)); w = 0 is
/// a step.
struct Search {
  double mu, w, low = 1, high = 3, width = 0.2;
  int runs = 40;

  [[nodiscard]] Onset run(std::mt19937_64& random) const {
    std::vector<Trial> trials;
    Onset onset = estimate_onset(trials, low, high, width);
    while (static_cast<int>(trials.size()) < runs && !settled(onset, low, high, width)) {
      for (const double x : next_places(onset, low, high, width, 3)) {
        const double p = w > 0 ? 1 / (1 + std::exp(-(x - mu) / w)) : (x > mu ? 1 : 0);
        trials.push_back({x, std::uniform_real_distribution<>(0, 1)(random) < p});
      }
      onset = estimate_onset(trials, low, high, width);
    }
    return onset;
  }
};

TEST(Onset, AStepIsFoundAndClosedOnBothSides) {
  std::mt19937_64 random(1);
  for (const double mu : {1.31, 1.8642, 2.4713}) {
    const Onset onset = Search{mu, 0}.run(random);
    ASSERT_TRUE(onset.value && onset.low && onset.high) << onset.text();
    EXPECT_NEAR(*onset.value, mu, 0.1);
    EXPECT_LT(*onset.low, mu);
    EXPECT_GT(*onset.high, mu);
    EXPECT_LE(*onset.high - *onset.low, 0.2 + 1e-9);
    EXPECT_LE(onset.n, 40U);
  }
}

TEST(Onset, IntervalsCoverAsOftenAsTheySay) {
  std::mt19937_64 random(2015);
  constexpr int kSearches = 60;
  for (const double w : {0.03, 0.1}) {
    int covered = 0;
    double sum = 0;
    for (int k = 0; k < kSearches; ++k) {
      const double mu = std::uniform_real_distribution<>(1.6, 2.4)(random);
      const Onset onset = Search{.mu = mu, .w = w}.run(random);
      covered += onset.low.value_or(-1e9) <= mu && mu <= onset.high.value_or(1e9) ? 1 : 0;
      sum += onset.value.value_or(mu) - mu;
    }
    // 95 % of 60 is 57; fewer than 51 would occur once in hundreds of such tests.
    EXPECT_GE(covered, 51) << w;
    EXPECT_NEAR(sum / kSearches, 0, 0.03) << w;
  }
  // The interval is also narrow enough: for a law with this noise it spans a few widths of the law.
  const Onset onset = Search{.mu = 2, .w = 0.1, .runs = 60}.run(random);
  ASSERT_TRUE(onset.low && onset.high);
  EXPECT_LT(*onset.high - *onset.low, 0.5);
}

// A result that falls with the key has no onset, however the runs were placed; a rising one is never said to
// fall.
TEST(Onset, AFallingAnswerIsNoOnset) {
  std::mt19937_64 random(5);
  int fell = 0, rose = 0;
  for (int k = 0; k < 40; ++k) {
    std::vector<Trial> falling, rising;
    for (int i = 0; i < 24; ++i) {
      const double x = 1 + 2 * (i + 0.5) / 24, p = 1 / (1 + std::exp((x - 2) / 0.1));
      falling.push_back({x, std::uniform_real_distribution<>(0, 1)(random) < p});
      rising.push_back({x, !falling.back().yes});
    }
    const Onset none = estimate_onset(falling, 1, 3, 0.2);
    fell += none.falls ? 1 : 0;
    EXPECT_FALSE(none.falls && (none.value || none.low || none.high));
    rose += estimate_onset(rising, 1, 3, 0.2).falls ? 0 : 1;
  }
  EXPECT_EQ(fell, 40);
  EXPECT_EQ(rose, 40);
  // As a search places them: the first runs rise nowhere, and the search ends.
  std::vector<Trial> trials;
  Onset onset = estimate_onset(trials, 1, 3, 0.2);
  while (trials.size() < 60 && !settled(onset, 1, 3, 0.2)) {
    for (const double x : next_places(onset, 1, 3, 0.2, 3)) trials.push_back({x, x < 2});
    onset = estimate_onset(trials, 1, 3, 0.2);
  }
  EXPECT_TRUE(onset.falls) << onset.text();
  EXPECT_NE(onset.text().find("none, as the answers change from yes to no: yes in "), std::string::npos);
}

TEST(Onset, ASingleFlipIsNoOnset) {
  const Onset onset = estimate_onset({{1.4, false}, {1.6, true}}, 1, 3, 0.1);
  EXPECT_FALSE(onset.low && onset.high && *onset.high - *onset.low < 1);
}

TEST(Onset, AllOrNoneIsALimit) {
  std::mt19937_64 random(3);
  const Onset never = Search{9, 0}.run(random), always = Search{-9, 0}.run(random);
  EXPECT_FALSE(never.value || never.high);
  ASSERT_TRUE(never.low);
  EXPECT_GT(*never.low, 2.5);
  EXPECT_NE(never.text().find("above"), std::string::npos);
  EXPECT_FALSE(always.value || always.low);
  ASSERT_TRUE(always.high);
  EXPECT_LT(*always.high, 1.5);
  EXPECT_NE(always.text().find("below"), std::string::npos);
}

// ln L = 4 ln(1/2) for a single group of two negative and two positive answers. In the limit of the largest w
// the profile is flat, and it is symmetric about the group.
TEST(Onset, TheEstimateIsSymmetric) {
  const Onset onset = estimate_onset(
      {{1.5, false}, {1.5, false}, {2.5, true}, {2.5, true}, {2, true}, {2, false}}, 1, 3, 0.1);
  ASSERT_TRUE(onset.value);
  EXPECT_NEAR(*onset.value, 2, 1e-6);
}

TEST(Onset, RunsGoWhereTheOnsetMayBe) {
  std::vector<Trial> trials;
  for (int k = 0; k < 6; ++k) {
    trials.push_back({1.5, false});
    trials.push_back({2.0, true});
  }
  const Onset onset = estimate_onset(trials, 1, 3, 0.1);
  for (const double x : next_places(onset, 1, 3, 0.1, 3)) {
    EXPECT_GE(x, 1.4);
    EXPECT_LE(x, 2.1);
  }
}

}  // namespace
}  // namespace twincell::sweep::onset_test
