// Fits of data whose truth is known: exact data to 1e-10, noisy data with the coverage that the errors
// promise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "analysis/trajectory/error.hpp"
#include "calibration/curves.hpp"
#include "calibration/plate_motion.hpp"

using namespace twincell;

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
  // Sampled once per period, offset and phase are one number.
  std::vector<HeightSample> strobe;
  for (int i = 0; i < 20; ++i) strobe.push_back({2 * kPi * i, 0.5});
  const PlateMotion blind = fit_plate_motion(strobe, 1);
  EXPECT_TRUE(blind.fit.standard_errors.empty());
  EXPECT_FALSE(blind.fit.why_not.empty());
}

TEST(Arrhenius, ExactData) {
  std::vector<SlipPoint> points;
  for (const double k_m : {3.0, 4.0, 5.5, 8.0, 12.0, 20.0})
    points.push_back({k_m, std::exp(1.3 - 7 / k_m), 0});
  const CurveFit f = fit_arrhenius(points);
  std::cout << "error of E_b: " << f.fit.value("E_b") - 7 << ", of c: " << f.fit.value("c") - 1.3 << '\n';
  EXPECT_NEAR(f.fit.value("E_b"), 7, 1e-10);
  EXPECT_NEAR(f.fit.value("c"), 1.3, 1e-10);
}

TEST(Arrhenius, BinomialCountsGiveTheCoverageTheyPromise) {
  std::mt19937_64 generator(5);
  const int trials = 1000;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    std::vector<SlipPoint> points;
    for (const double k_m : {2.0, 2.5, 3.0, 4.0, 6.0, 10.0}) {
      const int n = 40000;
      std::binomial_distribution<int> slips(n, std::exp(-7 / k_m));
      points.push_back({k_m, static_cast<double>(slips(generator)) / n, static_cast<double>(n)});
    }
    const CurveFit f = fit_arrhenius(points);
    covered += std::abs(f.fit.value("E_b") - 7) <= 1.96 * f.fit.standard_error("E_b") ? 1 : 0;
  }
  std::cout << "coverage of the 95 % interval of E_b: " << 100.0 * covered / trials << " %\n";
  EXPECT_GE(covered, 930);
  EXPECT_LE(covered, 970);
}

TEST(Arrhenius, PointsWithoutLogarithm) {
  const std::vector<SlipPoint> points = {{3, 0, 1e5},
                                         {4, std::exp(-7.0 / 4), 1e5},
                                         {6, std::exp(-7.0 / 6), 1e5},
                                         {8, std::exp(-7.0 / 8), 1e5},
                                         {9, std::nan(""), 1e5}};
  const CurveFit f = fit_arrhenius(points);
  EXPECT_EQ(f.n_zero, 1U);
  EXPECT_EQ(f.n_invalid, 1U);
  EXPECT_EQ(f.n_used, 3U);
  EXPECT_NEAR(f.fit.value("E_b"), 7, 1e-9);
  ASSERT_EQ(upper_limits(points).size(), 1U);
  EXPECT_DOUBLE_EQ(upper_limits(points)[0], 3e-5);
}

TEST(Arrhenius, RefusalsNameTheWindowAndTheData) {
  const std::vector<SlipPoint> points = {{3, 0.1, 0}, {4, 0.2, 0}};
  try {
    fit_arrhenius(points, {10, 20});
    FAIL();
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("[10, 20]"), std::string::npos) << text;
    EXPECT_NE(text.find("[3, 4]"), std::string::npos) << text;
  }
  EXPECT_THROW(fit_arrhenius({}), InputError);
  EXPECT_THROW(fit_arrhenius({{3, 0.1, 0}}), InputError);
  EXPECT_THROW(fit_arrhenius({{3, 0.1, 0}, {3, 0.2, 0}}), InputError);
  const CurveFit two = fit_arrhenius(points);
  EXPECT_TRUE(two.fit.standard_errors.empty());
  EXPECT_NE(two.flag.find("two points"), std::string::npos);
  const CurveFit constant = fit_arrhenius({{3, 0.1, 0}, {4, 0.1, 0}, {5, 0.1, 0}});
  EXPECT_NEAR(constant.fit.value("E_b"), 0, 1e-12);
  EXPECT_EQ(constant.flag, "constant ordinate");
}

TEST(PowerLaw, ExactDataAndZeroPoints) {
  std::vector<CurvePoint> points;
  for (const double x : {0.5, 1.0, 2.0, 3.0, 5.0, 9.0})
    points.push_back({x, x < 1.5 ? 0.0 : 0.3 * std::pow(x, 1.49)});
  const CurveFit f = fit_power_law(points, {0.9, 8});
  EXPECT_EQ(f.n_zero, 1U);
  EXPECT_EQ(f.n_outside, 2U);
  EXPECT_EQ(f.n_used, 3U);
  EXPECT_NEAR(f.fit.value("alpha"), 1.49, 1e-10);
  EXPECT_NEAR(f.fit.value("ln_C"), std::log(0.3), 1e-10);
}
