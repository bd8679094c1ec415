#include "trajectory/drive.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace twincell::drive_test {
namespace {

// MODEL: omega = 1 makes A = Gamma and K_m = Gamma^2; W of the second paper is K_m.
TEST(Drive, PaperOneNumbers) {
  const Drive d = solve_drive({.omega = 1.0, .gamma = 1.8}, 1, {});
  EXPECT_DOUBLE_EQ(d.amplitude, 1.8);
  EXPECT_DOUBLE_EQ(d.k_m(), 3.24);
  EXPECT_DOUBLE_EQ(d.period(), 2 * std::numbers::pi);
}

TEST(Drive, EveryIndependentPairGivesTheSameDrive) {
  const double a = 0.7, w = 3.1;
  const DriveSpec all{a, w, w / (2 * std::numbers::pi), a * w * w, a * a * w * w, a * w};
  const std::vector<DriveSpec> pairs = {
      {.amplitude = all.amplitude, .omega = all.omega},
      {.amplitude = all.amplitude, .frequency = all.frequency},
      {.amplitude = all.amplitude, .gamma = all.gamma},
      {.amplitude = all.amplitude, .k_m = all.k_m},
      {.omega = all.omega, .k_m = all.k_m},
      {.gamma = all.gamma, .k_m = all.k_m},
      {.gamma = all.gamma, .peak_velocity = all.peak_velocity},
      {.frequency = all.frequency, .peak_velocity = all.peak_velocity},
  };
  for (const DriveSpec& spec : pairs) {
    const Drive d = solve_drive(spec, 1, {});
    EXPECT_NEAR(d.amplitude, a, 1e-14);
    EXPECT_NEAR(d.omega, w, 1e-14);
  }
  EXPECT_NO_THROW(solve_drive(all, 1, {}));
}

TEST(Drive, TwoIndependentNumbersAreWhole) {
  EXPECT_FALSE(is_whole({}));
  EXPECT_FALSE(is_whole({.gamma = 2}));
  EXPECT_FALSE(is_whole({.omega = 1, .frequency = 1 / (2 * std::numbers::pi)}));
  EXPECT_FALSE(is_whole({.k_m = 4, .peak_velocity = 2}));
  EXPECT_TRUE(is_whole({.amplitude = 2, .gamma = 2}));
  EXPECT_TRUE(is_whole({.omega = 1, .k_m = 4}));
  EXPECT_TRUE(is_whole({.gamma = 2, .peak_velocity = 2}));
}

TEST(Drive, ContradictionAndShortageAreNamed) {
  const Where where{"scene.toml", 7, 1, "drive"};
  try {
    solve_drive({.amplitude = 2.0, .omega = 1.0, .gamma = 1.8}, 1, where);
    FAIL() << "a contradictory drive was accepted";
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::usage);
    EXPECT_NE(std::string(e.what()).find("scene.toml:7:1: drive: gamma = 1.8"), std::string::npos)
        << e.what();
  }
  EXPECT_THROW(solve_drive({.gamma = 1.8}, 1, where), ConfigError);
  EXPECT_THROW(solve_drive({.k_m = 4.0, .peak_velocity = 2.0}, 1, where),
               ConfigError);  // the same quantity given twice
  EXPECT_THROW(solve_drive({.omega = 1.0, .gamma = -1.0}, 1, where), ConfigError);
  EXPECT_THROW(solve_drive({.omega = 0.0, .gamma = 1.0}, 1, where), ConfigError);
  // Without gravity Gamma is undefined.
  EXPECT_THROW(solve_drive({.omega = 1.0, .gamma = 1.0}, 0, where), ConfigError);
  EXPECT_THROW(solve_drive({.omega = std::nan(""), .gamma = 1.0}, 1, where), ConfigError);
}

TEST(Drive, PlateAtRest) {
  const Drive d = solve_drive({.omega = 2.0, .gamma = 0.0}, 1, {});
  EXPECT_EQ(d.amplitude, 0);
  EXPECT_EQ(d.omega, 2);
  EXPECT_EQ(d.displacement(0.37), 0);
}

TEST(Drive, VelocityAndAccelerationAreDerivatives) {
  for (const Drive& d :
       {Drive{Axis::z, 1.3, 0.8}, Drive{Axis::z, 1.3, 0.8, {{0.2, 0.1}, {0.0, 0.5}, {0.05, 0.9}}}})
    for (const double f : {0.0, 0.21, 0.5, 0.83}) {
      const double h = 1e-6, span = 2 * h * d.period();
      EXPECT_NEAR(d.velocity(f), (d.displacement(f + h) - d.displacement(f - h)) / span, 1e-8);
      EXPECT_NEAR(d.acceleration(f), (d.velocity(f + h) - d.velocity(f - h)) / span, 1e-8);
    }
}

// A plate without harmonics, and one whose harmonics have no amplitude, move as a sine to the last bit.
TEST(Drive, NoHarmonicsAreASineToTheBit) {
  const double a = 1.3, w = 0.8;
  for (const Drive& d : {Drive{Axis::z, a, w}, Drive{Axis::z, a, w, {{0, 0.3}, {0, 0}}}})
    for (int k = 0; k < 1000; ++k) {
      const double f = k / 1000.0;
      EXPECT_EQ(d.displacement(f), a * std::sin(2 * std::numbers::pi * f));
      EXPECT_EQ(d.velocity(f), a * w * std::cos(2 * std::numbers::pi * f));
    }
  const Drive sine{Axis::z, a, w};
  EXPECT_EQ(sine.displacement_bound(), a);
  EXPECT_EQ(sine.velocity_bound(), sine.peak_velocity());
  EXPECT_EQ(sine.peak_fall(), sine.gamma());
  EXPECT_EQ(sine.formula(), "A sin(omega t)");
}

// z = A (sin t + cos(2t)/4), z'' = -A (sin t + cos 2t) with sin t + cos 2t = s + 1 - 2s^2: at most 9/8, at
// s = 1/4. With the opposite sign of cos 2t it is s - 1 + 2s^2: at most 2, at s = 1.
TEST(Drive, PeakFallOfTwoHarmonics) {
  EXPECT_NEAR((Drive{Axis::z, 2, 1, {{0.25, 0.25}}}.peak_fall()), 2 * 1.125, 1e-9);
  EXPECT_NEAR((Drive{Axis::z, 2, 1, {{0.25, 0.75}}}.peak_fall()), 2 * 2.0, 1e-9);
  const Drive d{Axis::z, 2, 1.5, {{0.25, 0.1}, {0.1, 0.7}}};
  for (int k = 0; k < 1000; ++k) {
    EXPECT_LE(std::abs(d.displacement(k / 1000.0)), d.displacement_bound());
    EXPECT_LE(std::abs(d.velocity(k / 1000.0)), d.velocity_bound());
    EXPECT_LE(-d.acceleration(k / 1000.0), d.peak_fall());
  }
  EXPECT_DOUBLE_EQ(d.displacement_bound(), 2 * 1.35);
  EXPECT_DOUBLE_EQ(d.velocity_bound(), 3 * 1.8);
  EXPECT_EQ(d.formula(), "A (sin(omega t) + 0.25 sin(2 omega t + 2 pi 0.1) + 0.1 sin(3 omega t + 2 pi 0.7))");
}

}  // namespace
}  // namespace twincell::drive_test
