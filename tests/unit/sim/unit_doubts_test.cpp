// Numbers of a scene in another unit than their keys name.

#include "sim/scene/unit_doubts.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/scene/read_scene.hpp"

namespace twincell::sim::unit_doubts_test {
namespace {

/// The doubts about a usual cell in which some keys differ.
std::vector<std::string> doubts_with(const std::vector<std::string>& assignments) {
  return doubtful_units(read_scene_text(
      "[beads]\ncount = 40\n[cell]\nwidth = 8.0\n[drive]\ngamma = 2.0\nomega = 1.0\n[contact]\nmu = 0.3\n",
      "scene.toml", assignments));
}

void expect_one(const std::vector<std::string>& assignments, const std::string& part) {
  const std::vector<std::string> doubts = doubts_with(assignments);
  ASSERT_EQ(doubts.size(), 1U) << part;
  EXPECT_NE(doubts[0].find(part), std::string::npos) << doubts[0];
}

TEST(UnitDoubts, NoneAboutAUsualScene) {
  EXPECT_TRUE(doubts_with({}).empty());
  EXPECT_TRUE(doubts_with({"contact.mu=1e6"}).empty());  // beads that never slip
  EXPECT_TRUE(doubts_with({"beads.radius=0.6"}).empty());
  EXPECT_TRUE(doubts_with({"drive.gamma=0.0"}).empty());  // a plate at rest
}

TEST(UnitDoubts, OfFrictionInPercent) {
  expect_one({"contact.mu=30"},
             "contact.mu = 30 is more friction than beads have; a coefficient of 30 % is 0.3");
  expect_one({"contact.wall.mu=30"}, "contact.wall.mu = 30");
}

TEST(UnitDoubts, OfADiameterAsRadius) {
  expect_one({"beads.radius=1.0"}, "are 2 sigma wide");
}

TEST(UnitDoubts, OfGravityInMetres) {
  expect_one({"cell.gravity=9.81"}, "is in units of g, in which that of the Earth is 1");
  expect_one({"scale.sigma_mm=2.0", "scale.gravity_m_s2=1.0", "cell.width_mm=16.0", "drive.omega_per_t0=1.0"},
             "gravity is 1 m/s^2; if 1 g is meant");
}

// 50 Hz, or 50 rad/s, in a scene whose times are in t0.
TEST(UnitDoubts, OfFrequenciesWithoutAScale) {
  expect_one({"drive.omega=50.0"}, "the amplitude of the plate is 0.0008 sigma");
  expect_one({"drive.frequency=50.0"}, "the amplitude of the plate is 2.03e-05 sigma");
  expect_one({"drive.gamma=1000.0"}, "Gamma = A omega^2/g is 1e+03");
}

}  // namespace
}  // namespace twincell::sim::unit_doubts_test
