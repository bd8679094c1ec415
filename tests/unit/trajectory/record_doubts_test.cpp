// Records that can be read but may not be what their user believes.
#include "trajectory/record_doubts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/constants.hpp"

namespace twincell::record_doubts_test {
namespace {

/// Ten cycles of a sine of amplitude 1 as an instrument shows them.
std::vector<double> sine(int per_cycle, const std::function<double(double)>& shown) {
  std::vector<double> values;
  for (int i = 0; i < 10 * per_cycle; ++i) values.push_back(shown(std::sin(kTurn * (i + 0.3) / per_cycle)));
  return values;
}

double rounded(double y, double step) {
  return std::round(y / step) * step;
}

// A sine that is cut at a share c of its amplitude is there for 2 arccos(c)/pi of the time.
TEST(RecordDoubts, ARecordThatWasCutOffIsNamed) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  for (const double c : {0.5, 0.8, 0.95}) {
    const double share = 100 * 2 * std::acos(c) / (kTurn / 2);
    for (const auto& shown : std::vector<std::function<double(double)>>{
             [&](double y) { return std::clamp(y, -c, c); },
             [&](double y) { return std::clamp(rounded(y, 1.0 / 2048), -c, c); },
             [&](double y) { return std::clamp(y + noise(random), -c, c); }}) {
      const std::string said = doubt_of_clipping(sine(100, shown));
      ASSERT_NE(said, "") << c;
      EXPECT_NEAR(std::stod(said), share, 0.1 * share + 1) << said;
      EXPECT_NE(said.find("was the range of the instrument exceeded?"), std::string::npos);
    }
    EXPECT_NE(doubt_of_clipping(sine(100, [&](double y) { return std::min(y, c); })), "") << "on one side";
  }
}

TEST(RecordDoubts, CrestsOfASineAreNone) {
  std::mt19937_64 random(1);
  for (const int per_cycle : {8, 20, 100, 1000, 5000})
    for (const double step : {1e-9, 1.0 / 2048, 1.0 / 128, 1.0 / 16}) {
      EXPECT_EQ(doubt_of_clipping(sine(per_cycle, [&](double y) { return rounded(y, step); })), "")
          << per_cycle << " samples of resolution " << step;
      for (const double sigma : {0.3, 1.0, 3.0}) {
        std::normal_distribution<double> noise(0, sigma * step);
        EXPECT_EQ(
            doubt_of_clipping(sine(per_cycle, [&](double y) { return rounded(y + noise(random), step); })),
            "")
            << per_cycle << " samples of resolution " << step << ", noise " << sigma;
      }
    }
  EXPECT_EQ(doubt_of_clipping({}), "");
  EXPECT_EQ(doubt_of_clipping(std::vector<double>(100, 2.0)), "");
}

TEST(RecordDoubts, GravityTellsTheUnit) {
  const auto with_mean = [](double mean) { return sine(100, [mean](double y) { return mean + 1.5 * y; }); };
  EXPECT_NE(doubt_of_unit(with_mean(9.81)).find("their mean is 9.81 g, where gravity gives 1 g"),
            std::string::npos);
  EXPECT_NE(doubt_of_unit(with_mean(-9.7)), "");
  EXPECT_NE(doubt_of_unit(with_mean(1 / 9.81)).find("their mean is 0.99"), std::string::npos);
  for (const double mean : {0.0, 1.0, -1.0, 0.012, 0.2, 5.0, 10.5, 100.0})
    EXPECT_EQ(doubt_of_unit(with_mean(mean)), "") << mean;
  EXPECT_EQ(doubt_of_unit({}), "");
}

}  // namespace
}  // namespace twincell::record_doubts_test
