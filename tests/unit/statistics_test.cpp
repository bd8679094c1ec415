#include "analysis/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

using namespace twincell;

TEST(Statistics, StudentTAgainstTables) {
  EXPECT_NEAR(student_t_95(1), 12.706, 1e-3);
  EXPECT_NEAR(student_t_95(9), 2.262, 1e-3);
  EXPECT_NEAR(student_t_95(40), 2.0211, 1e-4);
  EXPECT_NEAR(student_t_95(120), 1.9799, 1e-4);
}

TEST(Statistics, BlockIntervalCoversTheMeanOfACorrelatedSeries) {
  // AR(1) with correlation time 10: the naive error would be sqrt(19/1) = 4.4 times too small.
  std::mt19937_64 generator(5);
  std::normal_distribution<double> kick;
  const int trials = 600;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    BlockAverage average;
    double x = 3 * kick(generator);
    for (int i = 0; i < 3000; ++i) {
      x = 0.9 * x + kick(generator);
      average.add(5 + x);
    }
    const auto interval = average.interval("values");
    ASSERT_TRUE(interval.has_value());
    covered += interval->low <= 5 && 5 <= interval->high ? 1 : 0;
  }
  std::cout << "coverage of the 95 % block interval: " << 100.0 * covered / trials << " %\n";
  EXPECT_GT(covered, trials * 0.90);
  EXPECT_LT(covered, trials * 0.985);
}

TEST(Statistics, BlockMeanIsTheMean) {
  BlockAverage average;
  EXPECT_TRUE(std::isnan(average.mean()));
  for (int i = 1; i <= 1001; ++i) average.add(i);
  EXPECT_DOUBLE_EQ(average.mean(), 501);
  EXPECT_EQ(average.n(), 1001U);
  BlockAverage three;
  for (int i = 0; i < 3; ++i) three.add(i);
  EXPECT_FALSE(three.interval("values").has_value());
}

TEST(Statistics, BootstrapOfAMeanHasItsStandardError) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> value;
  std::vector<double> sample(400);
  for (double& v : sample) v = value(generator);
  const auto mean = [&](const std::vector<std::size_t>& pick) {
    double sum = 0;
    for (const std::size_t i : pick) sum += sample[i];
    return sum / static_cast<double>(pick.size());
  };
  const auto interval = bootstrap_interval(sample.size(), mean, "values", 1, 4000);
  ASSERT_TRUE(interval.has_value());
  const double half = (interval->high - interval->low) / 2;
  std::cout << "half width " << half << ", expected " << 1.96 / 20 << '\n';
  EXPECT_NEAR(half, 1.96 / 20, 0.012);
  const auto again = bootstrap_interval(sample.size(), mean, "values", 1, 4000);
  EXPECT_EQ(again->low, interval->low);
  EXPECT_FALSE(bootstrap_interval(1, mean, "values").has_value());
}
