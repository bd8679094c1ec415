// V5.3: T_g of Maxwellian velocities with a translation common to all beads.
#include "analysis/granular_temperature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/validation.hpp"

using namespace twincell;

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
