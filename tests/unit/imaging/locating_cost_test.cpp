// The measurement of errors and run times of the locator: choices made by hand, the noise of s_b by random
// sampling, and a small run against the Cramér-Rao bound.

#include "imaging/benchmark/locating_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace twincell::imaging::locating_cost_test {
namespace {

LocatePrecision row(int sweeps, double rms, double ms, double recall = 1) {
  LocatePrecision p;
  p.setting.sweeps = sweeps;
  p.recall = recall;
  p.precision = 1;
  p.rms = rms;
  p.seconds = 1e-3 * ms;
  return p;
}

TEST(LocatingCost, FrontAndCheapest) {
  std::vector<LocatePrecision> all = {row(30, 0.006, 40), row(0, 0.2, 5),         row(1, 0.05, 12),
                                      row(2, 0.06, 15),   row(3, 0.001, 3, 0.99), row(4, 0.006, 41)};
  LocatePrecision other = row(7, 0.0001, 1);
  other.setting.snr = 164;
  all.push_back(other);
  const auto kept = front(all, 15, 51);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].setting.sweeps, 0);
  EXPECT_EQ(kept[1].setting.sweeps, 1);
  EXPECT_EQ(kept[2].setting.sweeps, 30);
  EXPECT_EQ(cheapest(all, 15, 51, 0.1)->setting.sweeps, 1);
  EXPECT_EQ(cheapest(all, 15, 51, 0.006)->setting.sweeps, 30);
  EXPECT_FALSE(cheapest(all, 15, 51, 0.0059));
  EXPECT_EQ(cheapest(all, 15, 164, 0.01)->setting.sweeps, 7);
  EXPECT_FALSE(cheapest(all, 20, 51, 1));
}

TEST(LocatingCost, NoiseOfTheBedsDisplacement) {
  constexpr int kTracers = 20, kCycles = 3, kPhases = 20, kDraws = 2000;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> error(0, 0.01);
  double squares = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    double sum = 0, sum2 = 0;
    for (int k = 0; k < kPhases; ++k) {
      double height = 0;
      for (int i = 0; i < kTracers * kCycles; ++i) height += error(generator) / (kTracers * kCycles);
      sum += height / kPhases;
      sum2 += height * height / kPhases;
    }
    squares += (sum2 - sum * sum) / kDraws;
  }
  // s_b^2 from 20 phases has a relative scatter of one third; its mean over 2000 draws has one of 0.7 %.
  EXPECT_NEAR(std::sqrt(squares) / bed_displacement_noise(0.01, kTracers, kCycles, kPhases), 1, 0.015);
  EXPECT_NEAR(bed_displacement_noise(1, 1, 1, 2), std::sqrt(0.5), 1e-15);
}

TEST(LocatingCost, FitsAreAtTheBoundAndFindersAreNot) {
  const std::vector<LocateSetting> settings = {{},
                                               {.sweeps = 0},
                                               {.finder = "hough", .sweeps = 0},
                                               {.snr = 18.5},
                                               {.diameter_px = 30},
                                               {.method = "fast"},
                                               {.method = "edges"}};
  const auto all = locate_precision(settings, {.beads = 200, .width = 20, .height = 20, .frames = 2}, 1);
  ASSERT_EQ(all.size(), settings.size());
  for (const LocatePrecision& p : all) {
    std::printf("%s, %d sweeps, %g px, SNR %g: rms %.5f, bound %.5f, %.1f ms\n", p.setting.finder.c_str(),
                p.setting.sweeps, p.setting.diameter_px, p.setting.snr, p.rms, p.bound, 1e3 * p.seconds);
    EXPECT_GT(p.seconds, 1e-4);
    EXPECT_LT(p.seconds, 10);
    if (p.setting.sweeps == 0) {
      EXPECT_GE(p.rms, 5 * p.bound);
      EXPECT_LE(p.rms, 0.5);
      continue;
    }
    EXPECT_TRUE(p.complete());
    if (p.setting.method != "exact") {
      EXPECT_GE(p.rms, 1.2 * p.bound);
      EXPECT_LE(p.rms, 0.2);
      continue;
    }
    EXPECT_GE(p.rms, 0.85 * p.bound);  // 800 errors: 2.5 % scatter
    EXPECT_LE(p.rms, 1.3 * p.bound);
  }
  EXPECT_NEAR(all[3].bound / all[0].bound, 51 / 18.5, 0.05);  // apart from rounding to 8 bits
}

}  // namespace
}  // namespace twincell::imaging::locating_cost_test
