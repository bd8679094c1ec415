// Where the plate is in a frame: stored, from the drive, or unknown; along z and sideways.
#include "trajectory/plate.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace twincell::plate_test {

namespace {

TrajectoryInfo driven_along(Axis axis) {
  TrajectoryInfo info;
  info.drive = Drive{axis, 2, 1};
  info.phases_per_cycle = 4;
  return info;
}

Frame at_phase(int phase) {
  Frame frame;
  frame.phase = phase;
  return frame;
}

}  // namespace

TEST(PlateHeight, MeasuredBeforeDriveBeforeNothing) {
  TrajectoryInfo info;
  Frame frame;
  EXPECT_FALSE(plate_height(info, frame).has_value());
  info = driven_along(Axis::z);
  EXPECT_FALSE(plate_height(info, frame).has_value());
  frame.phase = 1;
  EXPECT_NEAR(*plate_height(info, frame), 2, 1e-15);  // A sin(pi/2)
  frame.plate_height = 0.7;
  EXPECT_EQ(*plate_height(info, frame), 0.7);
  EXPECT_EQ(sideways_displacement(info, frame), Vec3::Zero());
}

TEST(PlateHeight, OfADriveAlongXOrYIsZeroAndTheCellIsDisplaced) {
  for (const Axis axis : {Axis::x, Axis::y}) {
    const TrajectoryInfo info = driven_along(axis);
    const Vec3 along = Vec3::Unit(static_cast<int>(axis));
    Frame frame = at_phase(1);
    EXPECT_EQ(plate_height(info, frame), 0.0);
    EXPECT_NEAR((sideways_displacement(info, frame) - 2 * along).norm(), 0, 1e-15);  // A sin(pi/2)
    frame.plate_height = -0.7;
    EXPECT_EQ(plate_height(info, frame), 0.0);
    EXPECT_EQ(plate_displacement(info, frame), -0.7);
    EXPECT_EQ(sideways_displacement(info, frame), -0.7 * along);
    EXPECT_FALSE(plate_rests(info, frame));
  }
}

TEST(PlateHeight, RestsWhereTheDriveMovesAndTheStoredHeightIsZero) {
  const TrajectoryInfo info = driven_along(Axis::z);
  for (const int phase : {0, 1, 2, 3}) {
    Frame frame = at_phase(phase);
    EXPECT_FALSE(plate_rests(info, frame)) << "without a stored height";
    frame.plate_height = 0;
    EXPECT_EQ(plate_rests(info, frame), phase % 2 == 1) << phase;  // at 0 and pi the drive passes 0 as well
    frame.plate_height = 2;
    EXPECT_FALSE(plate_rests(info, frame));
  }
}

}  // namespace twincell::plate_test
