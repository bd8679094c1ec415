// Numbers of a trajectory that contradict each other.
#include "trajectory/trajectory_doubts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace twincell::trajectory_doubts_test {
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

// The numbers of the beads are those of the rows of a table, whose order changes once.
TEST(TrajectoryDoubts, BeadsThatExchangeTheirPlaces) {
  const MemoryTrajectory bed = riding_bed(20, 1, 0.45);
  MemoryTrajectory shuffled(bed.info());
  Frame frame;
  for (std::size_t f = 0; f < bed.n_frames(); ++f) {
    bed.read(f, frame);
    for (std::size_t i = 0; i < 50; ++i) {
      const std::size_t row = f >= 25 ? (i * 7 + 3) % 50 : i;
      const auto place = static_cast<double>(row * row);  // no lattice
      frame.position[i] = bed.frames()[f].position[row] + 0.04 * Vec3(std::sin(place), 0, std::cos(place));
    }
    shuffled.append(frame);
  }
  const std::string said = doubts(shuffled);
  EXPECT_NE(said.find("between the frames of the steps 24 and 25, 50 beads take the places of others: the "
                      "numbers count the rows of a frame"),
            std::string::npos)
      << said;
  EXPECT_EQ(said.find("velocities say"), std::string::npos) << said;
}

// One row of a crystal that slips by a place in every frame, and a gas that flies far, keep their numbers.
TEST(TrajectoryDoubts, MotionIsNoExchange) {
  TrajectoryInfo info;
  info.n_beads = 200;
  info.box.upper = Vec3(40, 1, 40);
  MemoryTrajectory slipping(info), flying(info);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(0, 40);
  for (int f = 0; f < 10; ++f) {
    Frame row, gas;
    row.step = gas.step = f;
    row.time = gas.time = f;
    for (int i = 0; i < 200; ++i) {
      row.position.emplace_back(i % 20 + 0.5 + (i / 20 > 5 ? f : 0), 0, i / 20 + 0.5);
      gas.position.emplace_back(place(random), 0, place(random));
    }
    slipping.append(row);
    flying.append(gas);
  }
  EXPECT_EQ(doubts(slipping).find("take the places"), std::string::npos) << doubts(slipping);
  EXPECT_EQ(doubts(flying).find("take the places"), std::string::npos) << doubts(flying);
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

}  // namespace twincell::trajectory_doubts_test
