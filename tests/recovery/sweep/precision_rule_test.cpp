// A run that ends when its mean is known precisely enough, on series with a known mean.
#include "sweep/precision_rule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sweep::precision_rule_test {
namespace {

sim::Scene scene_of(const std::string& until) {
  return sim::read_scene_text(
      "preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 9.0\n[time]\nphases = 1\ncycles = "
      "100000\n[until]\n" +
          until,
      "gas.toml");
}

TrajectoryInfo two_beads() {
  TrajectoryInfo info;
  info.n_beads = 2;
  info.columns.velocity = info.columns.phase = true;
  info.phases_per_cycle = 1;
  return info;
}

/// Two beads that separate with m <w'^2> = t.
Frame frame_of(std::int64_t cycle, double t) {
  Frame frame;
  frame.cycle = cycle;
  frame.phase = 0;
  frame.position = {Vec3(0, 0, 1), Vec3(0, 0, 2)};
  frame.velocity = {Vec3(3, 0, 5 + std::sqrt(t)), Vec3(3, 0, 5 - std::sqrt(t))};
  return frame;
}

/// Temperatures about 1 whose fluctuations decay by the factor `memory` per cycle.
class Series {
 public:
  Series(double memory, double deviation, std::mt19937_64& generator)
      : memory_(memory), fresh_(deviation * std::sqrt(1 - memory * memory)), generator_(generator) {}
  double next() {
    off_ = memory_ * off_ + fresh_ * one_(generator_);
    return 1 + off_;
  }

 private:
  double memory_, fresh_, off_ = 0;
  std::mt19937_64& generator_;
  std::normal_distribution<double> one_;
};

TEST(PrecisionRule, EndsWhereTheErrorOfACorrelatedSeriesIsReachedAndTellsTheTruth) {
  std::mt19937_64 generator(3);
  const sim::Scene scene = scene_of("quantity = \"T_z\"\nrelative_error = 0.02\n");
  constexpr int kRuns = 400;
  constexpr double kMemory = 0.8, kDeviation = 0.1;  // tau = (1 + a)/(2 (1 - a)) = 4.5
  int right = 0;
  double cycles = 0;
  for (int k = 0; k < kRuns; ++k) {
    PrecisionRule rule(scene, two_beads());
    Series series(kMemory, kDeviation, generator);
    double sum = 0;
    std::int64_t j = 0;
    for (bool reached = false; !reached; ++j) {
      const double t = series.next();
      sum += t;
      reached = rule.reached(frame_of(j, t));
    }
    EXPECT_TRUE(rule.is_reached());
    cycles += static_cast<double>(j) / kRuns;
    right += std::abs(sum / static_cast<double>(j) - 1) <= 0.02 ? 1 : 0;
  }
  // Repeated tests stop the run a little early on average, so slightly fewer than 95 % of the
  // runs are within the error.
  test::validate(
      {"H38", "runs, %, whose mean is within the error they ended at", 93, 5, "95 % and the looks"},
      100.0 * right / kRuns);
  // n = 2 tau (t sigma/error)^2 with t between 2 and 2.3.
  test::validate({"H38", "cycles run until 2 % are reached", 2 * 4.5 * std::pow(2.15 * 0.1 / 0.02, 2), 350,
                  "closed form"},
                 cycles);
}

TEST(PrecisionRule, SaysWhenTheCapEndedTheRun) {
  sim::Scene scene = scene_of("quantity = \"T_bar_z\"\nrelative_error = 0.001\n");
  scene.cycles = 40;
  PrecisionRule rule(scene, two_beads());
  std::mt19937_64 generator(4);
  Series series(0, 0.1, generator);
  for (int j = 0; j < 40; ++j) EXPECT_FALSE(rule.reached(frame_of(j, series.next())));
  EXPECT_EQ(rule.text().find("the cap of 40 cycles ended the run: T_bar_z is known to "), 0U) << rule.text();
  EXPECT_NE(rule.text().find("0.1 % was asked"), std::string::npos) << rule.text();
}

TEST(PrecisionRule, AnAbsoluteErrorEndsASolidBed) {
  const sim::Scene scene = scene_of("quantity = \"T_bar_z\"\nrelative_error = 0.01\nabsolute_error = 1e-5\n");
  PrecisionRule rule(scene, two_beads());
  std::mt19937_64 generator(5);
  Series series(0, 0.9, generator);
  std::int64_t j = 0;
  while (!rule.reached(frame_of(j, 1e-7 * std::abs(series.next())))) ASSERT_LT(++j, 130);
  EXPECT_EQ(j, 114);  // the first test: 40 flights of Gamma/pi periods at K_m = 9
}

TEST(PrecisionRule, AQuantityItDoesNotKnowIsRefusedWithThoseItKnows) {
  try {
    const PrecisionRule rule(scene_of("quantity = \"q6\"\n"), two_beads());
    FAIL();
  } catch (const ConfigError& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find("gas.toml:8"), std::string::npos) << said;
    EXPECT_NE(said.find("until.quantity"), std::string::npos) << said;
    EXPECT_NE(said.find("T_bar_z"), std::string::npos) << said;
  }
  EXPECT_THROW(scene_of("relative_error = 0.01\n"), ConfigError);
  EXPECT_THROW(scene_of("quantity = \"T_z\"\nrelative_error = 0.0\n"), ConfigError);
}

}  // namespace
}  // namespace twincell::sweep::precision_rule_test
