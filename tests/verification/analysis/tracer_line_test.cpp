// Drift and annealing of tracer lines whose motion is known; growth rates in closed form.
#include "analysis/motion/tracer_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/observable/observable.hpp"
#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::tracer_line_test {

using namespace analysis;

namespace {

template <class Height>
TracerLine line_of(std::size_t tracers, std::size_t cycles, const Height& height) {
  TracerLine line{.n_tracers = tracers};
  for (std::size_t j = 0; j < cycles; ++j) {
    line.cycle.push_back(static_cast<std::int64_t>(j) + 10);
    for (std::size_t t = 0; t < tracers; ++t) line.height.push_back(height(j, t));
  }
  return line;
}

/// Independent random steps of the tracers: s_j^2 grows by step^2 (1 - 1/N) a cycle, on average.
TracerLine diffusing(std::size_t tracers, std::size_t cycles, double step, std::size_t until,
                     std::mt19937_64& generator) {
  std::normal_distribution<double> kick(0, step);
  std::vector<double> z(tracers, 8.0);
  return line_of(tracers, cycles, [&](std::size_t j, std::size_t t) {
    if (j > 0 && j < until) z[t] += kick(generator);
    return z[t];
  });
}

}  // namespace

TEST(TracerLine, WordsForKnownMotions) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> kick;
  const auto word = [](const TracerLine& line, double noise = 0) {
    const DriftVerdict verdict = judge_drift(line, noise);
    EXPECT_FALSE(verdict.reason.empty());
    return drift_name(verdict.drift);
  };
  EXPECT_EQ(word(line_of(20, 200, [](std::size_t, std::size_t) { return 5.0; })), "still");
  // The whole bed rises: the tracers do not move relative to each other.
  EXPECT_EQ(word(line_of(20, 200, [](std::size_t j, std::size_t) { return 0.1 * static_cast<double>(j); })),
            "still");
  // The random bed of paper 1 at N_l = 20: it moves for about ten cycles, then freezes with s_j > sigma.
  EXPECT_EQ(word(diffusing(20, 200, 0.4, 12, generator)), "annealed");
  // A line sheared at a constant rate.
  EXPECT_EQ(word(line_of(20, 200,
                         [](std::size_t j, std::size_t t) {
                           return 0.003 * static_cast<double>(j) * (static_cast<double>(t) - 9.5);
                         })),
            "drifting");
  // Tracers that have spread over the whole bed: they still move, but their spread is constant.
  EXPECT_EQ(word(line_of(20, 200, [&](std::size_t, std::size_t) { return 10 + 3 * kick(generator); })),
            "mixing");
  // Camera noise of 0.03 sigma does not count as motion.
  const TracerLine noisy =
      line_of(20, 200, [&](std::size_t, std::size_t) { return 8 + 0.03 * kick(generator); });
  EXPECT_EQ(word(noisy, 0.03), "still");
  EXPECT_EQ(word(noisy, 0), "mixing");
  EXPECT_EQ(judge_drift(line_of(20, 7, [](std::size_t, std::size_t) { return 5.0; }), 0).drift,
            Drift::undetermined);
  EXPECT_EQ(judge_drift(line_of(1, 70, [](std::size_t, std::size_t) { return 5.0; }), 0).drift,
            Drift::undetermined);
}

TEST(TracerLine, GrowthOfAShearedLineIsItsClosedForm) {
  // s_j^2 = a^2 j^2 (N^2 - 1)/12; the least-squares slope of j^2 over j = 0 .. n-1 is n - 1.
  const double a = 0.02, n = 20, cycles = 50;
  const TracerLine line = line_of(20, 50, [&](std::size_t j, std::size_t t) {
    return a * static_cast<double>(j) * static_cast<double>(t);
  });
  const Growth rate = growth(line, 0, 50);
  test::validate({"V5.4", "d s_j^2/dj of a line that shears by 0.02 a cycle",
                  a * a * (n * n - 1) / 12 * (cycles - 1), 1e-12, "closed form"},
                 rate.rate);
  ASSERT_TRUE(rate.interval.has_value());
  EXPECT_GT(rate.interval->low, 0);
  EXPECT_NE(rate.interval->method.find("over tracers"), std::string::npos);
}

TEST(TracerLine, GrowthOfDiffusingTracersCoversItsRate) {
  std::mt19937_64 generator(8);
  const int seeds = 400;
  const double step = 0.1, truth = step * step * (1 - 1 / 20.0);
  int covered = 0;
  double sum = 0;
  for (int s = 0; s < seeds; ++s) {
    const Growth rate = growth(diffusing(20, 60, step, 60, generator), 0, 60);
    sum += rate.rate;
    ASSERT_TRUE(rate.interval.has_value());
    covered += rate.interval->low <= truth && truth <= rate.interval->high ? 1 : 0;
  }
  test::validate({"V5.4", "d s_j^2/dj of 20 diffusing tracers, mean over 400 seeds, over its exact value", 1,
                  0.06, "step^2 (1 - 1/N)"},
                 sum / seeds / truth);
  test::validate({"V5.12", "coverage, %, of the interval of d s_j^2/dj, 20 diffusing tracers, 60 cycles", 95,
                  2, "binomial"},
                 100.0 * covered / seeds);
}

TEST(TracerLine, MissingTracers) {
  const double nan = std::nan("");
  const TracerLine line = line_of(
      10, 3, [&](std::size_t j, std::size_t t) { return t < 2 * j + 1 ? nan : static_cast<double>(t); });
  std::vector<std::size_t> all(10);
  for (std::size_t t = 0; t < 10; ++t) all[t] = t;
  EXPECT_NEAR(spread_squared(line, 0, all), (81 - 1) / 12.0, 1e-12);  // 9 of 10 consecutive numbers
  EXPECT_TRUE(std::isnan(spread_squared(line, 1, all)));              // 7 of 10
}

TEST(DriftOfABed, ResultsCarryTheWordTheRateAndTheReason) {
  AnalysisOptions options;
  options.only = {"drift", "s_j_growth"};
  const auto results =
      analyze(test::rigid_bed({.gamma = 1.8, .phases = 4, .cycles = 20, .shear_per_cycle = 0.05}), options);
  EXPECT_EQ(find_result(results, "drift").text, "drifting");
  EXPECT_NE(find_result(results, "drift").convention.find("s_j^2 grows"), std::string::npos);
  EXPECT_GT(find_result(results, "s_j_growth").value(), 0);
  const auto still = analyze(test::rigid_bed({.gamma = 1.8, .phases = 4, .cycles = 20}), options);
  EXPECT_EQ(find_result(still, "drift").text, "still");
  EXPECT_NEAR(find_result(still, "s_j_growth").value(), 0, 1e-12);
  EXPECT_FALSE(find_result(analyze(test::rigid_bed({.phases = 4, .cycles = 4}), options), "drift").present());
}

TEST(DetectionLimits, StandBesideTheThreshold) {
  MemoryTrajectory seen = test::rigid_bed({.gamma = 0.9, .cycles = 6, .source = Origin::experiment});
  seen.info().scale.pixels_per_sigma = 20;
  seen.info().columns.position_sigma = true;
  MemoryTrajectory noisy(seen.info());
  for (Frame frame : seen.frames()) {
    frame.position_sigma.assign(frame.position.size(), Vec3(0.02, 0, 0.03));
    noisy.append(frame);
  }
  const auto results = analyze(noisy);
  const double tracers = static_cast<double>(find_result(results, "tracers").values.size());
  test::validate({"V5.9", "s_b floor of 0.03 sigma noise, 6 cycles", 0.03 / std::sqrt(tracers * 6), 1e-12,
                  "sigma/sqrt(N_t N_f)"},
                 find_result(results, "s_b_noise").value());
  EXPECT_DOUBLE_EQ(find_result(results, "half_pixel").value(), 0.025);
  EXPECT_NE(find_result(results, "half_pixel").convention.find("below sigma/30"), std::string::npos);
  EXPECT_FALSE(find_result(analyze(seen), "s_b_noise").present());
}

TEST(DetectionLimits, NoiseOfThatSizeGivesAnSbOfThatSize) {
  std::mt19937_64 generator(12);
  std::normal_distribution<double> noise(0, 0.03);
  double sum = 0;
  const int seeds = 200;
  for (int s = 0; s < seeds; ++s) {
    MemoryTrajectory still = test::rigid_bed({.gamma = 0.9, .columns = 8, .rows = 3, .cycles = 4});
    MemoryTrajectory seen(still.info());
    for (Frame frame : still.frames()) {
      for (Vec3& r : frame.position) r.z() += noise(generator);
      seen.append(frame);
    }
    AnalysisOptions options;
    options.tracers = {0, 1, 2, 3, 4, 5, 6, 7};
    options.only = {"s_b"};
    const double s_b = find_result(analyze(seen, options), "s_b").value();
    sum += s_b * s_b;
  }
  // The mean over the 20 phases is estimated too, hence 19/20.
  test::validate({"V5.9", "s_b of a resting bed seen with 0.03 sigma noise, 8 tracers, 4 cycles, 200 films",
                  0.03 / std::sqrt(8 * 4) * std::sqrt(19.0 / 20), 1.5e-4, "sigma/sqrt(N_t N_f)"},
                 std::sqrt(sum / seeds));
}

}  // namespace twincell::tracer_line_test
