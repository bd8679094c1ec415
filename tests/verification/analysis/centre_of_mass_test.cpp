// The height of the centre of mass of beds whose motion is known in closed form.
#include "analysis/motion/centre_of_mass.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::centre_of_mass_test {

using namespace analysis;

TEST(CentreOfMass, BouncingRigidBed) {
  const test::RigidBed bed{.gamma = 1.5, .columns = 10, .rows = 4, .phases = 40, .cycles = 6};
  // Rows at 1/2 + k sqrt(3)/2 with 10, 9, 10, 9 beads.
  const double rest = 0.5 + std::sqrt(3.0) / 2 * (0 * 10 + 1 * 9 + 2 * 10 + 3 * 9) / 38.0;
  double lift = 0;
  for (int k = 0; k < bed.phases; ++k)
    lift += test::rigid_bed_height(bed.gamma, 2 * std::numbers::pi * k / bed.phases) / bed.phases;
  const auto results = analyze(test::rigid_bed(bed), {.rest_height = rest});
  test::validate({"V5.16", "h_cm of the rigid bed at Gamma 1.5", rest + lift, 1e-12, "closed form"},
                 find_result(results, "h_cm").value());
  test::validate({"V5.16", "delta h_cm of the rigid bed at Gamma 1.5", lift, 1e-12, "closed form"},
                 find_result(results, "delta_h_cm").value());
  EXPECT_NEAR(find_result(results, "delta_h_bar").value(), lift / 2.25, 1e-12);
  // No bed lies higher at rest than it flies; 2.4 times the height, as of millimetres, is refused.
  EXPECT_NE(find_result(analyze(test::rigid_bed(bed), {.rest_height = 2.4 * rest}), "delta_h_cm")
                .absent.find("a bed at rest lies no higher: is it in sigma, and of this bed?"),
            std::string::npos);
  EXPECT_TRUE(
      find_result(analyze(test::rigid_bed(bed), {.rest_height = 1.1 * rest}), "delta_h_cm").present());
  const Result& by_phase = find_result(results, "h_cm_k");
  ASSERT_EQ(by_phase.values.size(), 40U);
  const double phi = 2 * std::numbers::pi * 10 / 40;
  EXPECT_NEAR(by_phase.values[10], rest + 1.5 + test::rigid_bed_height(1.5, phi), 1e-12);
  EXPECT_EQ(find_result(results, "h_cm_j").values.size(), 6U);
  // All cycles are equal, so there is no scatter from which to compute an interval.
  EXPECT_FALSE(find_result(results, "delta_h_cm").interval);
  EXPECT_FALSE(find_result(results, "delta_h_cm").no_interval.empty());
}

// delta_h_bar is in units of V_p^2/g. With g -> k^2 g and omega -> k omega, lengths and Gamma stay the same,
// V_p^2/g does, and so does the lift in its units.
TEST(CentreOfMass, LiftInUnitsOfTheDriveFollowsTheGravityOfTheRun) {
  const auto film = test::rigid_bed({.gamma = 1.5, .phases = 40, .cycles = 6});
  const AnalysisOptions options{.rest_height = 0.1};
  const double expected = find_result(analyze(film, options), "delta_h_cm").value() / 2.25;
  for (const double faster : {0.5, 3.0}) {
    MemoryTrajectory scaled = film;
    scaled.info().drive->gravity = faster * faster;
    scaled.info().drive->omega *= faster;
    test::validate({"V5.16", fmt::format("delta h_bar of the rigid bed at g = {:g}", faster * faster),
                    expected, 1e-12 * expected, "similarity"},
                   find_result(analyze(scaled, options), "delta_h_bar").value());
  }
}

TEST(CentreOfMass, WithoutARestHeightThereIsNoLift) {
  const auto results = analyze(test::rigid_bed({.cycles = 4, .velocities = false}));
  EXPECT_TRUE(find_result(results, "h_cm").present());
  EXPECT_NE(find_result(results, "delta_h_cm").absent.find("at rest"), std::string::npos);
}

TEST(CentreOfMass, ABedThatBeginsAtRestTellsItsRestHeight) {
  const auto shaken = [](double speed) {
    MemoryTrajectory t;
    t.info().n_beads = 2;
    t.info().phases_per_cycle = 2;
    t.info().columns = {.velocity = true, .phase = true, .plate_height = true};
    t.info().drive = Drive{.amplitude = 1.5, .omega = 1};
    for (int f = 0; f < 12; ++f) {
      Frame frame;
      frame.step = f;
      frame.phase = f % 2;
      frame.cycle = f / 2;
      frame.time = std::numbers::pi * f;
      frame.plate_height = 0.1;
      const double lift = f == 0 ? 0 : 0.25;
      frame.position = {Vec3(0, 0, 0.6 + lift), Vec3(0, 0, 1.6 + lift)};
      frame.velocity = {Vec3(0, 0, speed), Vec3(0, 0, speed)};
      t.append(frame);
    }
    return t;
  };
  // The plate passes its mean height at A omega = 1.5.
  const auto riding = analyze(shaken(1.5), {.discard_cycles = 1});
  // The rest height is 1 above the plate. h_cm is measured from the plate's mean height, 0.1 below the plate.
  test::validate({"V5.16", "lift over the first frame's rest height", 0.35, 1e-12, "closed form"},
                 find_result(riding, "delta_h_cm").value());
  EXPECT_NEAR(find_result(analyze(shaken(0)), "delta_h_cm").value(), 0.35 - 0.25 / 12, 1e-12);
  const std::string why = find_result(analyze(shaken(1.2)), "delta_h_cm").absent;
  EXPECT_NE(why.find("0.045 m g sigma"), std::string::npos) << why;
}

TEST(CentreOfMass, WeighsMassesAndSkipsEmptySlots) {
  Frame frame;
  frame.position = {Vec3(0, 0, 1), Vec3(0, 0, 4), Vec3::Constant(std::nan(""))};
  frame.id = {0, 1, -1};
  EXPECT_DOUBLE_EQ(centre_of_mass_height(frame, {2, 1, 5}), 2);
  frame.id = {-1, -1, -1};
  EXPECT_TRUE(std::isnan(centre_of_mass_height(frame, {})));
}

}  // namespace twincell::centre_of_mass_test
