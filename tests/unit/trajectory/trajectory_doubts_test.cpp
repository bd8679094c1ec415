// Numbers of a trajectory that contradict each other.
#include "trajectory/trajectory_doubts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace twincell {
namespace {

/// Five rows of ten touching beads on a plate at A sin(omega t), `phases` frames per cycle, for two cycles.
MemoryTrajectory riding_bed(int phases, double of_velocity, double radius) {
  TrajectoryInfo info;
  info.n_beads = 50;
  info.columns.velocity = true;
  info.columns.plate_height = true;
  info.box.upper = Vec3(10, 1, 20);
  info.drive = Drive{};
  info.drive->amplitude = 0.75;
  info.drive->omega = 1;
  info.phases_per_cycle = phases;
  info.radius.assign(50, radius);
  MemoryTrajectory bed(info);
  for (int f = 0; f < 2 * phases; ++f) {
    Frame frame;
    frame.step = f;
    frame.time = 2 * std::numbers::pi * (f + 0.25) / phases;
    frame.plate_height = 0.75 * std::sin(frame.time);
    for (int i = 0; i < 50; ++i) {
      frame.position.emplace_back(0.5 + i % 10, 0, frame.plate_height + 0.5 + i / 10);
      frame.velocity.emplace_back(0, 0, of_velocity * 0.75 * std::cos(frame.time));
    }
    bed.append(frame);
  }
  return bed;
}

std::string doubts(const MemoryTrajectory& bed) {
  std::string all;
  for (const std::string& one : doubts_of(bed, 1000)) all += one + "\n";
  return all;
}

}  // namespace

// With few frames per cycle the mean of two velocities is far from the mean velocity between them.
TEST(TrajectoryDoubts, NoneInABedThatRidesOnItsPlate) {
  for (const int phases : {2, 3, 4, 5, 8, 20}) EXPECT_EQ(doubts(riding_bed(phases, 1, 0.5)), "") << phases;
}

TEST(TrajectoryDoubts, VelocitiesThatTheBeadsDoNotMoveWith) {
  for (const double factor : {0.1, 0.5, 2.5, 10.0})
    EXPECT_NE(doubts(riding_bed(20, factor, 0.5)).find("times as far as their velocities say"),
              std::string::npos)
        << factor;
  EXPECT_NE(doubts(riding_bed(20, 10, 0.5)).find("beads move 0.101 times"), std::string::npos);
  EXPECT_NE(doubts(riding_bed(20, 0, 0.5)).find("all velocities are 0"), std::string::npos);
  EXPECT_NE(doubts(riding_bed(20, -1, 0.5)).find("along z the beads move against"), std::string::npos);
}

TEST(TrajectoryDoubts, RadiiThatAreDiameters) {
  // 49 of 50 beads touch an earlier one.
  EXPECT_NE(doubts(riding_bed(20, 1, 1)).find("98 % of the beads overlap an earlier one by more than 0.2"),
            std::string::npos)
      << doubts(riding_bed(20, 1, 1));
  EXPECT_EQ(doubts(riding_bed(20, 1, 0.55)), "");  // polydisperse beads, or measured ones
}

TEST(TrajectoryDoubts, OnlyTheFramesThatAreAskedForAreRead) {
  MemoryTrajectory bed = riding_bed(20, 1, 0.5);
  Frame below;
  bed.read(0, below);
  for (Vec3& r : below.position) r.z() -= 3;
  bed.append(below);
  EXPECT_EQ(doubts_of(bed, 40).size(), 0U);
  EXPECT_NE(doubts_of(bed, 41).size(), 0U);
}

}  // namespace twincell
