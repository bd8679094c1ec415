// Periods that are shorter than twice the reach of a neighbour are named.

#include "analysis/observable/short_periods.hpp"

#include <gtest/gtest.h>

namespace twincell::analysis::short_periods_test {
namespace {

TrajectoryInfo periodic(int dimension, const Vec3& size) {
  TrajectoryInfo info;
  info.box.dimension = dimension;
  info.box.upper = size;
  info.box.boundary.fill(Boundary::periodic);
  return info;
}

TEST(ShortPeriods, AreThoseBelowTwiceTheReach) {
  // In a plane the reach is 1.8, the diameter of a Voronoi cell; in space it is the cutoff, 1.2.
  EXPECT_TRUE(short_periods(periodic(2, Vec3(3.6, 1, 3.6)), {}).empty());
  EXPECT_TRUE(short_periods(periodic(3, Vec3(2.4, 2.4, 2.4)), {}).empty());
  const auto plane = short_periods(periodic(2, Vec3(3.5, 1, 10)), {});
  ASSERT_EQ(plane.size(), 1U);  // y has no meaning in a plane
  EXPECT_TRUE(
      plane[0].starts_with("the period along x, 3.5 sigma, is shorter than twice the reach of a "
                           "neighbour, 1.8 sigma"))
      << plane[0];
  EXPECT_EQ(short_periods(periodic(3, Vec3(2.3, 2, 10)), {}).size(), 2U);
  EXPECT_EQ(short_periods(periodic(3, Vec3(2.3, 2, 10)), {.neighbour_cutoff = 1.1}).size(), 1U);
  TrajectoryInfo walls = periodic(2, Vec3(1, 1, 1));
  walls.box.boundary.fill(Boundary::wall);
  EXPECT_TRUE(short_periods(walls, {}).empty());
}

}  // namespace
}  // namespace twincell::analysis::short_periods_test
