// Two highlights on each bead, and arrangements of discs that are none.
#include "imaging/settings/paired_spots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace twincell::imaging::paired_spots_test {
namespace {

constexpr double kBead = 20;

/// A disc at each of the offsets from the beads of a lattice that is jittered.
std::vector<Detection> spots(const std::vector<std::pair<double, double>>& offsets, double jitter) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> off(0, jitter);
  std::vector<Detection> all;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      const double x = kBead * (i + 0.5 * (j % 2)) + off(random), y = 0.87 * kBead * j + off(random);
      for (const auto& [dx, dy] : offsets) {
        Detection d;
        d.x = x + dx, d.y = y + dy, d.radius = 3;
        all.push_back(d);
      }
    }
  return all;
}

TEST(SpotPairs, TwoHighlightsOfEachBeadAreFoundInAnyDirection) {
  for (const double turn : {0.0, 0.8, 1.57, 2.5}) {
    const double dx = 4 * std::cos(turn), dy = 4 * std::sin(turn);
    const auto pairs = spot_pairs(spots({{dx, dy}, {-dx, -dy}}, 0.3));
    ASSERT_TRUE(pairs) << turn;
    EXPECT_NEAR(std::hypot(pairs->dx_px, pairs->dy_px), 8, 0.2);
    EXPECT_GE(pairs->dx_px, 0);
    EXPECT_NEAR(std::abs(pairs->dx_px * dy - pairs->dy_px * dx), 0, 1) << "along the lamps";
    EXPECT_EQ(pairs->middles.size(), 100U);
    EXPECT_TRUE(are_between(spots({{0, 0}}, 0.3), *pairs));
    EXPECT_FALSE(are_between(spots({{dx, dy}}, 0.3), *pairs)) << "on one of the highlights";
    EXPECT_NEAR(pairs->touching_px, kBead, 1.5);
  }
}

TEST(SpotPairs, OneOrThreeHighlightsAndDumbbellsAreNone) {
  EXPECT_FALSE(spot_pairs(spots({{0, 0}}, 0.3)));
  EXPECT_FALSE(spot_pairs(spots({{0, -4}, {3.5, 2}, {-3.5, 2}}, 0.3)));
  // Dumbbells in all directions.
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> turn(0, 6.28);
  std::vector<Detection> dumbbells = spots({{0, 0}, {0, 0}}, 0.3);
  for (std::size_t k = 0; k < dumbbells.size(); k += 2) {
    const double to = turn(random), dx = 4 * std::cos(to), dy = 4 * std::sin(to);
    dumbbells[k].x += dx, dumbbells[k].y += dy, dumbbells[k + 1].x -= dx, dumbbells[k + 1].y -= dy;
  }
  EXPECT_FALSE(spot_pairs(dumbbells));
}

// In a bed at rest the nearest neighbour touches, and so does the second.
TEST(SpotPairs, BeadsThatTouchAreNone) {
  EXPECT_FALSE(spot_pairs(spots({{0, 0}, {0.5 * kBead, 0}}, 0.2)));
}

}  // namespace
}  // namespace twincell::imaging::paired_spots_test
