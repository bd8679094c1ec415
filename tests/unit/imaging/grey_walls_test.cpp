// Walls that are not black, as red ones in grey levels.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging::grey_walls_test {
namespace {

constexpr int kWide = 240, kHigh = 200, kWall = 40, kDiameter = 20;
constexpr double kLight = 200;

/// A cell whose beads, walls and plate have one darkness, with two rows of beads in contact.
cv::Mat1b cell(double darkness) {
  const double dark = kLight * (1 - darkness);
  cv::Mat1f grey(kHigh, kWide, static_cast<float>(kLight));
  grey(cv::Rect(0, 0, kWall, kHigh)).setTo(dark);
  grey(cv::Rect(kWide - kWall, 0, kWall, kHigh)).setTo(dark);
  grey(cv::Rect(0, kHigh - kWall, kWide, kWall)).setTo(dark);
  for (int row = 0; row < 2; ++row)
    for (int x = kWall + kDiameter / 2; x < kWide - kWall; x += kDiameter)
      cv::circle(grey, {x, kHigh - kWall - kDiameter / 2 - row * kDiameter}, kDiameter / 2, dark, cv::FILLED,
                 cv::LINE_AA);
  cv::GaussianBlur(grey, grey, {0, 0}, 0.8);
  cv::Mat1b levels;
  grey.convertTo(levels, CV_8U);
  return levels;
}

TEST(GreyWalls, AreWallsAndBeadsOfTheirDarknessAreNot) {
  for (const double darkness : {1.0, 0.85, 0.78, 0.7, 0.6}) {
    const cv::Mat1b walls = prepare(cell(darkness), {}, kDiameter / 2.0).opaque;
    ASSERT_FALSE(walls.empty()) << darkness;
    for (const cv::Rect part : {cv::Rect(0, 0, kWall, kHigh), cv::Rect(kWide - kWall, 0, kWall, kHigh),
                                cv::Rect(0, kHigh - kWall, kWide, kWall)})
      EXPECT_EQ(cv::countNonZero(walls(part)), part.area()) << darkness;
    for (int row = 0; row < 2; ++row)
      for (int x = kWall + kDiameter / 2; x < kWide - kWall; x += kDiameter)
        EXPECT_EQ(walls(kHigh - kWall - kDiameter / 2 - row * kDiameter, x), 0) << darkness;
  }
}

// Single pixels of a noisy wall are lighter than its threshold; the wall is whole nevertheless, and no bead
// is part of it.
TEST(GreyWalls, NoisyWallsAreWhole) {
  cv::RNG random(7);
  for (const double darkness : {0.78, 0.8, 0.85})
    for (const double noise : {2.0, 3.0, 4.0}) {  // of 200 levels
      cv::Mat1b levels;
      cv::Mat1f grey = cell(darkness);
      cv::Mat1f error(grey.size());
      random.fill(error, cv::RNG::NORMAL, 0, noise);
      cv::Mat1f(grey + error).convertTo(levels, CV_8U);
      const cv::Mat1b walls = prepare(levels, {}, kDiameter / 2.0).opaque;
      ASSERT_FALSE(walls.empty()) << darkness << " " << noise;
      constexpr int kEdge = 2;  // px, whose place is uncertain
      for (const cv::Rect part :
           {cv::Rect(0, 0, kWall - kEdge, kHigh), cv::Rect(kWide - kWall + kEdge, 0, kWall - kEdge, kHigh),
            cv::Rect(0, kHigh - kWall + kEdge, kWide, kWall - kEdge)})
        EXPECT_EQ(cv::countNonZero(walls(part)), part.area()) << darkness << " " << noise;
      for (int row = 0; row < 2; ++row)
        for (int x = kWall + kDiameter / 2; x < kWide - kWall; x += kDiameter)
          EXPECT_EQ(walls(kHigh - kWall - kDiameter / 2 - row * kDiameter, x), 0) << darkness << " " << noise;
    }
}

}  // namespace
}  // namespace twincell::imaging::grey_walls_test
