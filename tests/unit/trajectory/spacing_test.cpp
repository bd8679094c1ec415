// Spacing of beads: lattices, pairs across the cells of the search, and every pair by comparison.

#include "trajectory/spacing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace twincell::spacing_test {
namespace {

std::vector<Vec3> square_lattice(int side, double spacing) {
  std::vector<Vec3> all;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) all.emplace_back(spacing * i, 0, spacing * j);
  return all;
}

TEST(Spacing, OfALatticeIsItsConstant) {
  EXPECT_DOUBLE_EQ(median_spacing(square_lattice(30, 1.5)), 1.5);
  EXPECT_TRUE(std::isnan(median_spacing({})));
  EXPECT_TRUE(std::isnan(median_spacing(square_lattice(1, 1))));
}

TEST(Spacing, BeadsThatAreNotFiniteAreLeftOut) {
  std::vector<Vec3> all = square_lattice(4, 2);
  all.insert(all.begin(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  all.insert(all.begin(), all.front());
  EXPECT_DOUBLE_EQ(median_spacing(all), 2);
  EXPECT_EQ(listed_again(all, 0.3), 0U);
}

TEST(Spacing, BeadsListedAgainAreCounted) {
  std::vector<Vec3> all = square_lattice(10, 1);
  EXPECT_EQ(listed_again(all, 0.3), 0U);
  all.push_back(all[3]);
  all.push_back(all[3]);                           // three of one bead: two too many
  all.push_back(all[50] + Vec3(-0.1, 0.1, -0.1));  // in another cell of the search
  all.push_back(all[70] + Vec3(0.31, 0, 0));       // beyond the distance
  EXPECT_EQ(listed_again(all, 0.3), 3U);
  EXPECT_EQ(listed_again({}, 0.3), 0U);
}

TEST(Spacing, MatchesTheCountOverAllPairs) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> any(-2, 2);
  std::vector<Vec3> all;
  for (int i = 0; i < 300; ++i) all.emplace_back(any(generator), any(generator), any(generator));
  std::size_t expected = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if ((all[i] - all[j]).norm() < 0.3) {
        ++expected;
        break;
      }
  ASSERT_GT(expected, 20U);
  EXPECT_EQ(listed_again(all, 0.3), expected);
}

}  // namespace
}  // namespace twincell::spacing_test
