#include "trajectory/trajectory.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace twincell::trajectory_test {

TEST(TrajectoryInfo, BeadsWithoutStoredSizeHaveTheUnits) {
  EXPECT_EQ(radius_of({}, 3), 0.5);
  EXPECT_EQ(mass_of({}, 3), 1);
  const std::vector<double> stored = {0.4, 0.7};
  EXPECT_EQ(radius_of(stored, 1), 0.7);
  EXPECT_EQ(mass_of(stored, 1), 0.7);
}

TEST(TrajectoryInfo, GravityIsThatOfTheRun) {
  TrajectoryInfo info;
  EXPECT_EQ(gravity_of(info), 1);
  info.source = Origin::simulation;
  info.drive = Drive{.omega = 1, .gravity = 0.5};
  EXPECT_EQ(gravity_of(info), 0.5) << "of another program, which states no conditions";
  info.conditions.n_l = 6;
  EXPECT_EQ(gravity_of(info), 0) << "no Gamma";
  info.conditions.gamma = 0.0;
  EXPECT_EQ(gravity_of(info), 0.5) << "a plate at rest";
  info.conditions.gamma.reset();
  info.drive->ramp.emplace();
  EXPECT_EQ(gravity_of(info), 0.5) << "a ramp has no one Gamma";
}

}  // namespace twincell::trajectory_test
