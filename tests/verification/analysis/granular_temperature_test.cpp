// V5.3: T_g of Maxwellian velocities with a translation common to all beads.
#include "analysis/gas/granular_temperature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/validation.hpp"

namespace twincell::granular_temperature_test {

using namespace analysis;

TEST(GranularTemperature, TranslationDropsOutAndTheFiniteSizeFactorStays) {
  std::mt19937_64 generator(11);
  const double temperature = 0.37;
  std::normal_distribution<double> component(0, std::sqrt(temperature));
  for (const std::size_t n : {std::size_t{4}, std::size_t{50}}) {
    const int samples = 40000;
    double sum = 0, worst_shift = 0;
    for (int s = 0; s < samples; ++s) {
      Frame still, moving;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 v(component(generator), 0, component(generator));
        still.position.emplace_back(0, 0, 0);
        still.velocity.push_back(v);
        moving.velocity.push_back(v + Vec3(3, 0, -7));
      }
      moving.position = still.position;
      const double t = granular_temperature(still, {});
      worst_shift = std::max(worst_shift, std::abs(granular_temperature(moving, {}) - t));
      sum += t;
    }
    const double expected = temperature * (1 - 1 / static_cast<double>(n));  // d T/2 with d = 2
    const double error = expected * std::sqrt(1.0 / (static_cast<double>(n - 1) * samples));
    const std::string of = " of " + std::to_string(n) + " Maxwellian beads";
    test::validate({"V5.3", "T_g" + of, expected, 4 * error, "closed form, with 1 - 1/N"}, sum / samples);
    test::validate({"V5.3", "T_g" + of + ": change by a common translation", 0, 1e-12, "Galilei"},
                   worst_shift);
  }
}

TEST(GranularTemperature, MassesWeighTheCentreOfMass) {
  Frame frame;
  frame.position = {Vec3::Zero(), Vec3::Zero()};
  frame.velocity = {Vec3(4, 0, 0), Vec3(0, 0, 0)};
  // m = 1, 3: v_cm = 1; (1/2)(1/2)(1*9 + 3*1) = 3.
  EXPECT_DOUBLE_EQ(granular_temperature(frame, {1, 3}), 3);
  EXPECT_TRUE(std::isnan(granular_temperature(Frame{}, {})));
}

namespace {

/// 200 beads in 2D whose velocities are the sum of a common translation, a wave in height and phase, and
/// Gaussian noise of variances t_x, t_z.
MemoryTrajectory gas(double t_x, double t_z, double wave, int cycles, std::mt19937_64& generator,
                     std::size_t beads = 200) {
  TrajectoryInfo info;
  info.n_beads = beads;
  info.columns.velocity = info.columns.phase = true;
  info.box.upper = Vec3(20, 1, 30);
  info.drive = Drive{Axis::z, 2, 1.5};
  info.phases_per_cycle = 4;
  MemoryTrajectory trajectory(info);
  std::normal_distribution<double> one;
  std::uniform_real_distribution<double> height(0, 10);
  for (int f = 0; f < 4 * cycles; ++f) {
    Frame frame;
    frame.step = f;
    frame.cycle = f / 4;
    frame.phase = f % 4;
    for (std::size_t i = 0; i < info.n_beads; ++i) {
      frame.position.emplace_back(10, 0, height(generator));
      const double layer = std::floor(frame.position.back().z());
      frame.velocity.emplace_back(
          3 + std::sqrt(t_x) * one(generator), 0,
          -1 + wave * (layer - 4.5) * (frame.phase % 2 == 0 ? 1 : -1) + std::sqrt(t_z) * one(generator));
    }
    trajectory.append(frame);
  }
  return trajectory;
}

}  // namespace

TEST(GranularTemperature, ConventionsOfBothPapersSideBySide) {
  std::mt19937_64 generator(21);
  const int cycles = 300;
  const double t_x = 0.4, t_z = 0.9, n = 200, v_p = 3;
  const auto results = analyze(gas(t_x, t_z, 0, cycles, generator));
  const double finite = 1 - 1 / n, samples = n * 4 * cycles;
  const auto expect = [&](const char* name, double value) {
    const Result& r = find_result(results, name);
    test::validate({"V5.3", std::string(name) + " of a Maxwellian gas, T_x = 0.4, T_z = 0.9, 200 beads",
                    value, 4 * value * std::sqrt(2 / samples), "closed form"},
                   r.value());
    EXPECT_FALSE(r.convention.empty());
    if (r.name != "T_z_field") {
      ASSERT_TRUE(r.interval.has_value()) << name;
      EXPECT_NE(r.interval->method.find("cycles"), std::string::npos);
      EXPECT_LT(r.interval->high - r.interval->low, 0.05 * value);
    }
  };
  expect("T_g", (t_x + t_z) / 2 * finite);
  expect("T_x", t_x * finite);
  expect("T_z", t_z * finite);
  expect("T", (t_x + t_z) / 2 * finite);
  expect("T_z_eq5", t_z / 2 * finite);
  expect("T_z_lab", t_z + 1);  // the gas drifts with w = -1
  expect("T_z_field", t_z);
  expect("T_bar_z", t_z * finite / (v_p * v_p));
  expect("T_bar", (t_x + t_z) / 2 * finite / (v_p * v_p));
  EXPECT_FALSE(find_result(results, "T_y").present());
}

TEST(GranularTemperature, TheFieldTakesOutAWaveThatTheCentreOfMassDoesNot) {
  std::mt19937_64 generator(22);
  const auto results = analyze(gas(0.4, 0.9, 0.5, 200, generator));
  // The wave is 0.5 (l - 4.5) over ten equally likely layers: variance 0.25 (10^2 - 1)/12.
  const double wave = 0.25 * 99 / 12;
  test::validate({"V5.3", "T_z about the centre of mass with a standing wave", (0.9 + wave) * (1 - 1 / 200.0),
                  0.03, "closed form"},
                 find_result(results, "T_z").value());
  test::validate({"V5.3", "T_z about the field of the same", 0.9, 0.015, "closed form"},
                 find_result(results, "T_z_field").value());
}

TEST(GranularTemperature, IntervalsCover) {
  std::mt19937_64 generator(23);
  const int seeds = 400;
  int covered = 0, given = 0;
  for (int s = 0; s < seeds; ++s) {
    AnalysisOptions options;
    options.only = {"T_g"};
    const auto interval = find_result(analyze(gas(0.4, 0.9, 0, 40, generator, 20), options), "T_g").interval;
    if (!interval) continue;  // 40 cycles are too few where they appear correlated by chance
    ++given;
    const double truth = 0.65 * (1 - 1 / 20.0);
    covered += interval->low <= truth && truth <= interval->high ? 1 : 0;
  }
  test::validate({"V5.12", "coverage, %, of the interval of T_g, 40 cycles", 95, 2, "binomial"},
                 100.0 * covered / given);
  EXPECT_GT(given, 0.9 * seeds);
}

TEST(GranularTemperature, AbsentWithoutVelocitiesOrDrive) {
  std::mt19937_64 generator(24);
  MemoryTrajectory still = gas(0.4, 0.9, 0, 3, generator);
  still.info().drive.reset();
  const auto undriven = analyze(still);
  EXPECT_FALSE(find_result(undriven, "T_bar_z").present());
  EXPECT_TRUE(find_result(undriven, "T_z").present());
  still.info().columns.velocity = false;
  for (const char* name :
       {"T_g", "T_x", "T_y", "T_z", "T", "T_z_eq5", "T_z_lab", "T_z_field", "T_bar_z", "T_bar"})
    EXPECT_FALSE(find_result(analyze(still), name).present()) << name;
}

namespace {

/// The time average of T_g is 1, 2, 3, … from cycle to cycle; the averages over the frames and over every
/// second sample are 1.1 and 0.98 times that. The cell holds two beads that separate.
MemoryTrajectory aliased(bool with_means) {
  TrajectoryInfo info;
  info.n_beads = 2;
  info.columns.velocity = info.columns.phase = true;
  info.columns.time_mean = with_means;
  info.box.upper = Vec3(20, 1, 30);
  info.phases_per_cycle = 4;
  info.samples_per_cycle = with_means ? 400 : 0;
  MemoryTrajectory t(info);
  for (int f = 0; f < 4 * 60; ++f) {
    Frame frame;
    frame.step = f;
    frame.cycle = f / 4;
    frame.phase = f % 4;
    frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
    const double over_time = 1 + frame.cycle % 3;
    const double v = std::sqrt(2 * 1.1 * over_time);
    frame.velocity = {Vec3(0, 0, v), Vec3(0, 0, -v)};
    if (with_means && f > 0) frame.time_mean = {Vec3(0, 0, 2 * over_time), Vec3(0, 0, 2 * 0.98 * over_time)};
    t.append(frame);
  }
  return t;
}

}  // namespace

TEST(GranularTemperature, UsesStoredTimeMeansAndReportsAliasing) {
  const auto results = analyze(aliased(true));
  // Cycle 0 has no mean before its first frame: 59 cycles of 2, 3, 1, 2, 3, 1, …, 2, 3.
  EXPECT_NEAR(find_result(results, "T_g").value(), (19 * 6 + 5) / 59.0, 1e-12);
  EXPECT_NE(find_result(results, "T_g").convention.find("time, 400 samples per cycle"), std::string::npos);
  EXPECT_NEAR(find_result(results, "T_z").value(), 2 * (19 * 6 + 5) / 59.0, 1e-12);
  EXPECT_NEAR(find_result(results, "T_g_aliasing").value(), 0.1, 1e-12);
  EXPECT_NEAR(find_result(results, "T_z_aliasing").value(), 0.1, 1e-12);
  EXPECT_NEAR(find_result(results, "T_g_sampling").value(), -0.02, 1e-12);
  EXPECT_EQ(find_result(results, "T_g_aliasing").n, 59U);
}

TEST(GranularTemperature, AliasingIsUnknownWithoutStoredTimeMeans) {
  const auto results = analyze(aliased(false));
  EXPECT_NEAR(find_result(results, "T_g").value(), 2.2, 1e-12);
  EXPECT_NE(find_result(results, "T_g").convention.find("the aliasing of 4 phases per cycle is not known"),
            std::string::npos);
  for (const char* name : {"T_g_aliasing", "T_z_aliasing", "T_g_sampling"})
    EXPECT_NE(find_result(results, name).absent.find("not known"), std::string::npos) << name;
}

}  // namespace twincell::granular_temperature_test
