// Fits of data with known parameters: exact data to 1e-10, noisy data with the stated coverage.
#include "calibration/drive/plate_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/error.hpp"

using namespace twincell;
using namespace twincell::calibration;

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<HeightSample> heights(double z0, double a, double omega, double phi, int n, double noise,
                                  std::mt19937_64& generator) {
  std::normal_distribution<double> error(0, 1);
  std::vector<HeightSample> samples;
  for (int i = 0; i < n; ++i) {
    const double t = 0.31 * i;
    samples.push_back({t, z0 + a * std::sin(omega * t + phi) + noise * error(generator)});
  }
  return samples;
}

}  // namespace

TEST(PlateMotion, ExactHeightsGiveTheMotionBack) {
  std::mt19937_64 generator(1);
  for (const double phi : {-3.0, -1.2, 0.0, 0.7, 2.9}) {
    const auto samples = heights(12.5, 1.7, 0.97, phi, 120, 0, generator);
    const PlateMotion known = fit_plate_motion(samples, 0.97);
    const PlateMotion searched = fit_plate_motion(samples, 0.96, true);
    for (const PlateMotion& m : {known, searched}) {
      EXPECT_TRUE(m.fit.usable);
      EXPECT_NEAR(m.z0, 12.5, 1e-10);
      EXPECT_NEAR(m.amplitude, 1.7, 1e-10);
      EXPECT_NEAR(m.phase, phi, 1e-10);
      EXPECT_NEAR(m.omega, 0.97, 1e-11);
    }
    std::cout << "phi " << phi << ": error of A " << searched.amplitude - 1.7 << ", of phi "
              << searched.phase - phi << '\n';
  }
}

TEST(PlateMotion, ErrorsCoverTheTruth) {
  std::mt19937_64 generator(2);
  const int trials = 800;
  int covered = 0;
  for (int i = 0; i < trials; ++i) {
    const PlateMotion m = fit_plate_motion(heights(0.3, 1.5, 1, 0.4, 60, 0.05, generator), 1);
    covered += std::abs(m.amplitude - 1.5) <= 2.0025 * m.fit.standard_error("A")
                   ? 1
                   : 0;  // t, 57 degrees of freedom
  }
  std::cout << "coverage of the 95 % interval of A: " << 100.0 * covered / trials << " %\n";
  EXPECT_GE(covered, 0.93 * trials);
  EXPECT_LE(covered, 0.97 * trials);
}

TEST(PlateMotion, WhatCannotBeFitted) {
  std::mt19937_64 generator(3);
  auto samples = heights(0, 1, 1, 0, 3, 0, generator);
  EXPECT_THROW(fit_plate_motion(samples, 1, true), InputError);
  EXPECT_THROW(fit_plate_motion(samples, 0), ConfigError);
  samples = heights(0, 1, 1, 0, 30, 0, generator);
  samples[4].height = std::nan("");
  const PlateMotion m = fit_plate_motion(samples, 1);
  EXPECT_EQ(m.n_left_out, 1U);
  EXPECT_NEAR(m.amplitude, 1, 1e-10);
  // With one sample per period, offset and phase cannot be separated.
  std::vector<HeightSample> strobe;
  for (int i = 0; i < 20; ++i) strobe.push_back({2 * kPi * i, 0.5});
  const PlateMotion blind = fit_plate_motion(strobe, 1);
  EXPECT_TRUE(blind.fit.standard_errors.empty());
  EXPECT_FALSE(blind.fit.why_not.empty());
}
