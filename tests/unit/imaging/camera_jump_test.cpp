// Jumps of a bumped camera, among beads and a plate that move by themselves.
#include "imaging/phase/camera_jump.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace twincell::imaging::camera_jump_test {
namespace {

constexpr double kDiameter = 12;
constexpr int kFramesPerCycle = 20;
constexpr std::size_t kFrames = 80;

/// Beads that wander between two walls; from a frame on, all of them are shifted, until another frame.
std::vector<std::vector<double>> beads(double shift, std::size_t from, std::size_t until = kFrames) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> step(0, 0.5);
  std::vector<double> x;
  for (int k = 0; k < 100; ++k) x.push_back(20 + kDiameter * (k % 10 + 0.5));
  std::vector<std::vector<double>> all;
  for (std::size_t f = 0; f < kFrames; ++f) {
    all.emplace_back();
    for (double& at : x) {
      at += step(random);
      all.back().push_back(at + (f >= from && f < until ? shift : 0));
    }
  }
  return all;
}

std::vector<CameraJump> jumps_of(const std::vector<std::vector<double>>& x_px) {
  std::vector<std::optional<Deciles>> deciles;
  for (const std::vector<double>& frame : x_px) deciles.push_back(deciles_of(frame));
  return jumps_of_beads(deciles, kDiameter);
}

/// Heights of a plate that follows a sine, read to 0.1 px.
std::vector<double> plate(double up, std::size_t from, std::size_t lost = kFrames) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<double> height;
  for (std::size_t f = 0; f < kFrames; ++f) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(f >= lost ? f + 1 : f) / kFramesPerCycle;
    height.push_back(30 + 19 * std::sin(turn) + noise(random) + (f >= from ? up : 0));
  }
  return height;
}

TEST(CameraJump, AllBeadsThatMoveTogetherAreAJump) {
  for (const double shift : {5.0, -3.0}) {
    const std::vector<CameraJump> jumps = jumps_of(beads(shift, 47));
    ASSERT_EQ(jumps.size(), 1U);
    EXPECT_EQ(jumps[0].frame, 47U);
    EXPECT_NEAR(jumps[0].right_px.value(), shift, 0.5);
    EXPECT_FALSE(jumps[0].down_px);
  }
}

TEST(CameraJump, BeadsThatWanderOrReturnAreNone) {
  EXPECT_TRUE(jumps_of(beads(0, 47)).empty());
  EXPECT_TRUE(jumps_of(beads(5, 47, 48)).empty()) << "a shake of one frame";
  // Half of the beads move.
  std::vector<std::vector<double>> half = beads(0, 0);
  for (std::size_t f = 47; f < kFrames; ++f)
    for (std::size_t k = 0; k < 100; ++k) half[f][k] += k % 10 < 5 ? 5 : 0;
  EXPECT_TRUE(jumps_of(half).empty());
}

TEST(CameraJump, ThePlateLeavesItsSineByAStep) {
  for (const double up : {4.0, -1.0}) {
    const std::optional<CameraJump> jump = jump_of_plate(plate(up, 47), kFramesPerCycle);
    ASSERT_TRUE(jump);
    EXPECT_EQ(jump->frame, 47U);
    EXPECT_NEAR(jump->down_px.value(), -up, 0.1);
  }
}

TEST(CameraJump, ASineALostFrameOrAnUnseenPlateAreNone) {
  EXPECT_FALSE(jump_of_plate(plate(0, 47), kFramesPerCycle));
  EXPECT_FALSE(jump_of_plate(plate(0, 47, 30), kFramesPerCycle));
  EXPECT_FALSE(jump_of_plate(plate(4, 47), 0)) << "no period is known";
  EXPECT_FALSE(
      jump_of_plate(std::vector<double>(kFrames, std::numeric_limits<double>::quiet_NaN()), kFramesPerCycle));
}

TEST(CameraJump, OneSentenceNamesFrameAndShift) {
  const std::vector<CameraJump> jumps =
      merged(jumps_of(beads(5, 47)), jump_of_plate(plate(4, 47), kFramesPerCycle));
  ASSERT_EQ(jumps.size(), 1U);
  const std::string text = in_words(jumps, kFrames);
  EXPECT_NE(text.find("from frame 47 on, plate and beads are shifted by ("), std::string::npos) << text;
  EXPECT_NE(text.find("--frames 0:47 and --frames 47:80"), std::string::npos) << text;
  EXPECT_TRUE(in_words({}, kFrames).empty());
  // Of two bumps, both are named in their order.
  EXPECT_EQ(merged(jumps_of(beads(5, 60)), jump_of_plate(plate(4, 47), kFramesPerCycle)).front().frame, 47U);
}

}  // namespace
}  // namespace twincell::imaging::camera_jump_test
