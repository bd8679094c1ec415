// The two rules of a quantile without interpolation.
#include "core/quantile.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/median.hpp"

namespace twincell::quantile_test {

TEST(Quantile, TakesTheStatedElement) {
  const std::vector<double> odd = {5, 1, 4, 2, 3}, even = {4, 1, 3, 2};
  EXPECT_EQ(lower_quantile(odd, 0), 1);
  EXPECT_EQ(lower_quantile(odd, 0.25), 2);
  EXPECT_EQ(lower_quantile(odd, 0.5), 3);
  EXPECT_EQ(lower_quantile(odd, 1), 5);
  EXPECT_EQ(lower_quantile(even, 0.5), 2);
  EXPECT_EQ(upper_quantile(odd, 0), 1);
  EXPECT_EQ(upper_quantile(odd, 0.5), upper_median(odd));
  EXPECT_EQ(upper_quantile(even, 0.5), upper_median(even));
  EXPECT_EQ(upper_quantile(even, 0.75), 4);
  EXPECT_EQ(lower_quantile(std::vector<float>{7}, 0.9), 7);
}

}  // namespace twincell::quantile_test
