// The power of the bead diameter in the units of results.
#include "analysis/runs/scaling_exponents.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "analysis/observable/observable.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis::scaling_exponents_test {

TEST(LengthPower, OfTheUnitsOfResults) {
  EXPECT_EQ(length_power("sigma"), 1);
  EXPECT_EQ(length_power("sigma^2"), 2);
  EXPECT_EQ(length_power("sigma^4"), 4);
  EXPECT_EQ(length_power("1/sigma"), -1);
  EXPECT_EQ(length_power("sigma per cycle"), 1);
  EXPECT_EQ(length_power("sigma^2 per cycle"), 2);
  for (const char* none : {"1", "", "cycles", "degrees", "m g", "frames"}) EXPECT_EQ(length_power(none), 0);
}

// With gravity as unit of acceleration, t0 = sqrt(sigma/g): a velocity is as sqrt(sigma), an energy as sigma.
TEST(LengthPower, TimeIsTheRootOfALength) {
  EXPECT_EQ(length_power("t0"), 0.5);
  EXPECT_EQ(length_power("sigma/t0"), 0.5);
  EXPECT_EQ(length_power("m g sigma"), 1);
  EXPECT_EQ(length_power("sigma/t0^2"), 0);
}

namespace {

/// A bed of 20 beads in motion, as seen at a scale that is too large by `scale`, on a plate whose amplitude
/// is too large by `drive`, both relative.
MemoryTrajectory filmed_bed(double scale, double drive) {
  const double length = 1 / (1 + scale);
  TrajectoryInfo info;
  info.n_beads = 20;
  info.columns.velocity = info.columns.phase = true;
  info.phases_per_cycle = 1;
  info.box.dimension = 2;
  info.box.upper = Vec3(10, 1, 50) * length;
  info.drive = Drive{.amplitude = 1.5 * (1 + drive), .omega = 1};
  MemoryTrajectory trajectory(info);
  for (int j = 0; j < 40; ++j) {
    Frame frame;
    frame.cycle = j;
    frame.phase = 0;
    frame.time = 2 * std::numbers::pi * j;
    for (int i = 0; i < 20; ++i) {
      frame.position.push_back(Vec3(i % 10 + 0.5, 0, i < 10 ? 0.5 : 9.5) * length);
      frame.velocity.push_back(Vec3(0, 0, (i + j) % 2 == 0 ? 1 : -1) * std::sqrt(length));
    }
    trajectory.append(frame);
  }
  return trajectory;
}

/// d ln X/d ln y by central differences. \param bed of an error of y
double derivative(const std::string& name, MemoryTrajectory (*bed)(double)) {
  constexpr double kStep = 1e-5;
  const auto at = [&](double error) {
    return find_result(analyze(bed(error), {.rest_height = 4.0, .only = {name}}), name).value();
  };
  return (at(kStep) - at(-kStep)) / (2 * kStep * at(0));
}

double by_scale(const std::string& name) {
  return derivative(name, [](double error) { return filmed_bed(error, 0); });
}
double by_drive(const std::string& name) {
  return derivative(name, [](double error) { return filmed_bed(0, error); });
}
Result result_of(const std::string& name) {
  return find_result(analyze(filmed_bed(0, 0), {.rest_height = 4.0, .only = {name}}), name);
}

}  // namespace

// -power is the derivative d ln X/d ln s by the scale, of numbers with units and of fillings without.
TEST(LengthPower, IsTheDerivativeByTheScale) {
  for (const char* name : {"h_cm", "T_z_eq5", "phi_cm"})
    EXPECT_NEAR(by_scale(name), -length_power(result_of(name), 2), 1e-6) << name;
  EXPECT_NEAR(by_scale("phi_cm"), 2, 1e-6);
  // The top is that of a bead, whose radius of 0.5 in a height of 10 is not measured.
  EXPECT_NEAR(by_scale("phi_top"), 1 + 9.5 / 10, 1e-6);
  EXPECT_NEAR(by_scale("phi_top"), -length_power(result_of("phi_top"), 2), 0.06);
  EXPECT_EQ(length_power(result_of("phi_cm"), 3), -3);
}

TEST(AmplitudePower, IsTheDerivativeByTheAmplitude) {
  for (const char* name : {"T_bar", "T_bar_z", "delta_h_bar", "T_z", "h_cm", "delta_h_cm", "phi_cm"})
    EXPECT_NEAR(by_drive(name), amplitude_power(result_of(name)), 1e-6) << name;
  EXPECT_EQ(amplitude_power(result_of("T_bar")), -2);
}

}  // namespace twincell::analysis::scaling_exponents_test
