#include "core/median.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

using namespace twincell;

TEST(Median, OfFewIsThatOfTheSorted) {
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
