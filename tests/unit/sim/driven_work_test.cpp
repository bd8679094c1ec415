// The forecast of a driven bed's work: its measured points, the bounds, and monotony between points.

#include "sim/run/driven_work.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace twincell::sim::driven_work_test {
namespace {

TEST(DrivenWork, ReturnsItsMeasuredPoints) {
  EXPECT_DOUBLE_EQ(driven_work(2, 10), 0.474);
  EXPECT_DOUBLE_EQ(driven_work(1.5, 40), 0.768);
  EXPECT_DOUBLE_EQ(driven_work(3, 80), 0.564);
  EXPECT_DOUBLE_EQ(driven_work(5, 160), 0.729);
}

// Runs of the first paper's preset from a crystal, apart from the runs of the table: user time of a step at
// Gamma = 2 over that at Gamma = 1, where the bed stays on the plate, for the same beads.
TEST(DrivenWork, ForecastsRunsOfThreeSizesWithin20Percent) {
  struct Run {
    double beads, width;     ///< width in bead diameters
    double at_rest, driven;  ///< million particle-steps per second of user time, one thread
  };
  for (const Run& r :
       {Run{200, 20, 95.7, 193.9}, Run{1600, 20, 98.3, 129.5}, Run{20'000, 250, 87.8, 120.7}}) {
    const double measured = r.at_rest / r.driven;
    EXPECT_NEAR(driven_work(2, r.beads / r.width) / measured, 1, 0.2) << r.beads;
  }
}

TEST(DrivenWork, IsLinearInGammaAndInTheLogarithmOfTheLayers) {
  EXPECT_NEAR(driven_work(2.5, 80), (0.781 + 0.564) / 2, 1e-12);
  EXPECT_NEAR(driven_work(2, std::sqrt(10.0 * 40.0)), (0.474 + 0.638) / 2, 1e-12);
}

TEST(DrivenWork, ABedThatStaysOnThePlateWorksLikeABedAtRest) {
  for (const double layers : {0.1, 10.0, 33.0, 1e6}) {
    EXPECT_EQ(driven_work(0, layers), 1);
    EXPECT_EQ(driven_work(1, layers), 1);
  }
}

TEST(DrivenWork, OutsideTheMeasuredRangeTheNearestValueApplies) {
  EXPECT_DOUBLE_EQ(driven_work(100, 1e9), 0.729);
  EXPECT_DOUBLE_EQ(driven_work(100, 1e-9), 0.298);
}

TEST(DrivenWork, DeeperBedsSaveLess) {
  for (double gamma = 1.25; gamma <= 5; gamma += 0.25)
    for (double layers = 10; layers < 150; layers *= 1.1)
      EXPECT_LT(driven_work(gamma, layers), driven_work(gamma, 1.1 * layers)) << gamma << ' ' << layers;
}

}  // namespace
}  // namespace twincell::sim::driven_work_test
