// Velocity autocorrelation of oscillators and of Brownian beads, in closed form.
#include "analysis/motion/velocity_autocorrelation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/known_beds.hpp"
#include "tests/support/validation.hpp"

namespace twincell::test::velocity_autocorrelation_test {
namespace {

constexpr std::size_t kBeads = 40;

/// Beads with friction `a` per frame: v_{k+1} = a v_k + sqrt(1 - a^2) xi, C(m) = a^m. All move along.
MemoryTrajectory brownian(double a, int frames, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MemoryTrajectory t = empty(2, Vec3(10, 1, 10), false);
  std::vector<Vec3> v(kBeads);
  for (Vec3& each : v) each = Vec3(normal(random), 0, normal(random));
  const double b = std::sqrt(1 - a * a);
  for (int f = 0; f < frames; ++f) {
    std::vector<Vec3> moving = v;
    for (Vec3& each : moving) each += Vec3(3 + 0.1 * f, 0, -1);
    add(t, std::vector<Vec3>(kBeads, Vec3(1, 0, 1)), moving);
    for (Vec3& each : v) each = a * each + b * Vec3(normal(random), 0, normal(random));
  }
  return t;
}

}  // namespace

TEST(VelocityAutocorrelation, OfOscillatorsIsTheCosine) {
  // The phases of the oscillators are evenly spread, which makes their mean velocity zero.
  constexpr double kOmega = 0.37;
  MemoryTrajectory t = empty(2, Vec3(10, 1, 10), false);
  for (int f = 0; f < 50; ++f) {
    std::vector<Vec3> v;
    for (std::size_t i = 0; i < kBeads; ++i) {
      const double phase = 2 * std::numbers::pi * static_cast<double>(i) / kBeads;
      v.emplace_back(2 * std::cos(kOmega * f + phase), 0, 0.5 * std::sin(kOmega * f + phase));
    }
    add(t, std::vector<Vec3>(kBeads, Vec3(1, 0, 1)), v);
  }
  const auto c = values_of(t, "vacf"), lag = values_of(t, "vacf_lag");
  ASSERT_EQ(c.size(), analysis::kLongestVelocityLag + 1);
  double worst = 0;
  for (std::size_t m = 0; m < c.size(); ++m)
    worst = std::max(worst, std::abs(c[m] - std::cos(kOmega * static_cast<double>(m))));
  validate({"V5.23", "C(t) of oscillators at 33 lags, largest error", 0, 1e-12, "cos(omega t)"}, worst);
  EXPECT_DOUBLE_EQ(lag.back(), static_cast<double>(analysis::kLongestVelocityLag));
}

TEST(VelocityAutocorrelation, OfBeadsThatAllMoveAlikeIsAbsent) {
  MemoryTrajectory t = empty(2, Vec3(10, 1, 10), false);
  for (int f = 0; f < 50; ++f)
    add(t, std::vector<Vec3>(kBeads, Vec3(1, 0, 1)), std::vector<Vec3>(kBeads, Vec3(0.7, 0, -0.1 * f)));
  const auto results = analysis::analyze(t, {.only = {"vacf"}});
  EXPECT_FALSE(analysis::find_result(results, "vacf").present());
}

TEST(VelocityAutocorrelation, OfBrownianBeadsDecaysExponentially) {
  std::mt19937_64 random(4);
  const auto c = values_of(brownian(0.8, 4000, random), "vacf");
  for (const std::size_t m : {0U, 1U, 3U, 8U, 30U})
    validate({"V5.23", "C(" + std::to_string(m) + ") of an Ornstein-Uhlenbeck process",
              std::pow(0.8, static_cast<double>(m)), 0.012, "a^m"},
             c[m]);
}

TEST(VelocityAutocorrelation, LiesInItsInterval) {
  std::mt19937_64 random(6);
  constexpr int kRuns = 400;
  constexpr std::size_t kLag = 2;
  int held = 0;
  for (int k = 0; k < kRuns; ++k) {
    analysis::AnalysisOptions options;
    options.only = {"vacf_low", "vacf_high"};
    const auto results = analysis::analyze(brownian(0.6, 150, random), options);
    held += analysis::find_result(results, "vacf_low").values[kLag] <= 0.36 &&
                    0.36 <= analysis::find_result(results, "vacf_high").values[kLag]
                ? 1
                : 0;
  }
  validate({"V5.23", "coverage of C(2), %", 95, 3.5, "binomial"}, 100.0 * held / kRuns);
}

TEST(VelocityAutocorrelation, IgnoresFramesAtOtherTimes) {
  std::mt19937_64 random(7);
  const MemoryTrajectory whole = brownian(0.9, 60, random);
  MemoryTrajectory gaps(whole.info());
  for (Frame frame : whole.frames()) {
    if (frame.cycle > 4 && frame.cycle % 3 == 0) frame.time += 0.4;
    gaps.append(frame);
  }
  MemoryTrajectory without(whole.info());
  for (const Frame& frame : whole.frames())
    if (frame.cycle <= 4 || frame.cycle % 3 != 0) without.append(frame);
  // A pair of two late frames has the right lag: only lags that are no multiple of 3 agree.
  const auto c = values_of(gaps, "vacf"), expected = values_of(without, "vacf");
  for (const std::size_t m : {1U, 2U, 4U}) EXPECT_NEAR(c[m], expected[m], 1e-12) << m;
}

}  // namespace twincell::test::velocity_autocorrelation_test
