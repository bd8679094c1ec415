#include "core/median.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace twincell::median_test {

TEST(Median, FewValuesAgreeWithSorting) {
  std::mt19937 random(3);
  for (std::size_t n = 1; n <= 64; ++n)
    for (const int kinds : {1, 3, 1000}) {  // from few distinct values (many ties) to many
      std::array<float, 64> few{};
      for (std::size_t k = 0; k < n; ++k)
        few.at(k) = static_cast<float>(std::uniform_int_distribution(-kinds, kinds)(random));
      std::vector<float> sorted(few.begin(), few.begin() + static_cast<std::ptrdiff_t>(n));
      EXPECT_EQ(upper_median_of_few(few, n), upper_median(sorted)) << n;
      std::sort(sorted.begin(), sorted.end());
      EXPECT_EQ(upper_median_of_few(few, n), sorted.at(n / 2)) << n;
    }
}

TEST(RobustSpread, IsTheStandardDeviationOfANormalDistribution) {
  constexpr double kMean = 7, kSigma = 0.3;
  constexpr std::size_t kValues = 100'000;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(kMean, kSigma);
  std::vector<double> values(kValues);
  for (double& v : values) v = normal(random);
  // Standard error of the median deviation: 1.166 sigma/sqrt(n).
  const double error = 1.166 * kSigma / std::sqrt(static_cast<double>(kValues));
  EXPECT_NEAR(robust_spread(values, upper_median(values)), kSigma, 4 * error);
  std::fill_n(values.begin(), kValues / 100, 1e9);
  EXPECT_NEAR(robust_spread(values, upper_median(values)), kSigma, 0.02 * kSigma);
}

TEST(RobustSpread, OfFewValues) {
  EXPECT_EQ(robust_spread({}), 0);
  EXPECT_EQ(robust_spread({-2.0}), 1.4826 * 2);
  EXPECT_EQ(robust_spread({4.0, 5.0, 9.0}, 5), 1.4826);
}

}  // namespace twincell::median_test
