#include "trajectory/wrapped_positions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace twincell::wrapped_positions_test {

namespace {

constexpr double kPeriod = 10;

PositionExtent extent_of(double from, double to) {
  PositionExtent extent;
  extent.add({from, 0, 0});
  extent.add({to, std::nan(""), 0});
  return extent;
}

TEST(PositionExtent, DecidesWhetherPositionsAreWrapped) {
  EXPECT_TRUE(extent_of(0.1, 9.9).is_wrapped(0, kPeriod));
  EXPECT_TRUE(extent_of(-4.9, 4.9).is_wrapped(0, kPeriod)) << "wherever the period begins";
  EXPECT_TRUE(extent_of(-1, 11).is_wrapped(0, kPeriod)) << "2 sigma more than the period";
  EXPECT_FALSE(extent_of(-1, 11.1).is_wrapped(0, kPeriod));
  EXPECT_TRUE(extent_of(-1, 11.1).is_wrapped(0, kPeriod, 1.1)) << "sigma in another unit";
  EXPECT_FALSE(extent_of(0, 0).is_wrapped(0, 0)) << "no period";
}

TEST(PeriodCounter, FollowsABeadAcrossSeveralPeriods) {
  constexpr double kSpeed = 3.7;
  PeriodCounter periods({kPeriod, 0, kPeriod}, 2);
  for (int f = 0; f < 12; ++f) {
    const double x = 2 + kSpeed * f, z = 8 - kSpeed * f;
    const Vec3 r = periods.unwrapped(
        1, {x - kPeriod * std::floor(x / kPeriod), x, z - kPeriod * std::floor(z / kPeriod)});
    EXPECT_NEAR(r.x(), x, 1e-12) << f;
    EXPECT_EQ(r.y(), x) << "not periodic";
    EXPECT_NEAR(r.z(), z, 1e-12) << f;
  }
  EXPECT_EQ(periods.unwrapped(0, {9.5, 0, 0.5}), Vec3(9.5, 0, 0.5)) << "a bead that was not seen before";
}

TEST(PeriodCounter, GoesOnFromTheLastKnownPlace) {
  PeriodCounter periods({kPeriod, kPeriod, kPeriod}, 1);
  EXPECT_EQ(periods.unwrapped(0, {9, 1, 5}), Vec3(9, 1, 5));
  EXPECT_TRUE(std::isnan(periods.unwrapped(0, Vec3::Constant(std::nan(""))).x()));
  EXPECT_EQ(periods.unwrapped(0, {1, 9, 5}), Vec3(11, -1, 5));
}

}  // namespace

}  // namespace twincell::wrapped_positions_test
