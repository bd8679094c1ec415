// The power of the bead diameter in the units of results.
#include "analysis/runs/length_power.hpp"

#include <gtest/gtest.h>

namespace twincell::analysis {

TEST(LengthPower, OfTheUnitsOfResults) {
  EXPECT_EQ(length_power("sigma"), 1);
  EXPECT_EQ(length_power("sigma^2"), 2);
  EXPECT_EQ(length_power("sigma^4"), 4);
  EXPECT_EQ(length_power("1/sigma"), -1);
  EXPECT_EQ(length_power("sigma per cycle"), 1);
  EXPECT_EQ(length_power("sigma^2 per cycle"), 2);
  for (const char* none : {"1", "", "cycles", "degrees", "m g", "frames"}) EXPECT_EQ(length_power(none), 0);
}

// With gravity as unit of acceleration, t0 = sqrt(sigma/g): a velocity is as sqrt(sigma), an energy as sigma.
TEST(LengthPower, TimeIsTheRootOfALength) {
  EXPECT_EQ(length_power("t0"), 0.5);
  EXPECT_EQ(length_power("sigma/t0"), 0.5);
  EXPECT_EQ(length_power("m g sigma"), 1);
  EXPECT_EQ(length_power("sigma/t0^2"), 0);
}

}  // namespace twincell::analysis
