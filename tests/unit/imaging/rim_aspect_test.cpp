// Extents of discs along y and x, for outlines of which they are known.
#include "imaging/refine/rim_aspect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/unit/imaging/outlines.hpp"

namespace twincell::imaging::rim_aspect_test {
namespace {

using namespace outlines;

/// Ellipses, upright, of a ratio of their heights to their widths.
cv::Mat1f stretched(double ratio, double noise) {
  const double half = std::sqrt(ratio);
  return objects(
      [half](double turn) { return kRadius / std::hypot(std::cos(turn) * half, std::sin(turn) / half); },
      noise, false);
}

Aspect aspect_of(const cv::Mat1f& grey, const std::vector<Detection>& of = discs(kRadius)) {
  RimAspect all;
  all.add(grey, of);
  EXPECT_TRUE(all.value());
  return all.value().value_or(Aspect{});
}

TEST(RimAspect, IsTheRatioOfHeightAndWidth) {
  for (const double ratio : {0.8, 0.93, 0.98, 1.0, 1.02, 1.08, 1.2}) {
    const Aspect aspect = aspect_of(stretched(ratio, 1));
    EXPECT_NEAR(aspect.ratio, ratio, 0.005) << ratio;
    EXPECT_LT(aspect.error, 0.003 + 0.06 * std::abs(ratio - 1)) << ratio;
    EXPECT_EQ(aspect.doubt().empty(), ratio == 1.0) << aspect.doubt();
  }
  EXPECT_NEAR(aspect_of(stretched(1.08, 20)).ratio, 1.08, 0.01);
}

TEST(RimAspect, IsNotChangedByMotionNorByAWrongCentre) {
  for (const double ratio : {1.0, 1.08}) {
    cv::Mat1f moved;
    cv::blur(stretched(ratio, 1), moved, {1, 5});
    EXPECT_NEAR(aspect_of(moved).ratio, ratio, 0.007);
    // If the bed rests in one of the frames, motion is told from stretch.
    RimAspect all;
    all.add(stretched(ratio, 1), {discs(kRadius)[0]}, {0, 1});
    for (int frame = 0; frame < 2; ++frame) all.add(moved, discs(kRadius), {0, std::sqrt(26)});
    EXPECT_NEAR(all.value().value_or(Aspect{}).ratio, ratio, 0.003);
    std::vector<Detection> off = discs(kRadius);
    for (Detection& d : off) d.x += 0.4, d.y -= 0.3;
    EXPECT_NEAR(aspect_of(stretched(ratio, 1), off).ratio, ratio, 0.003);
  }
}

// Above all discs of a row is a dark bar, as the wall of a cell; they touch it.
TEST(RimAspect, LeavesOutWalls) {
  for (const double ratio : {1.0, 1.08}) {
    cv::Mat1f grey = stretched(ratio, 1);
    for (int row = 0; row < kSide / kPitch; ++row)
      grey(cv::Rect(0, row * kPitch, kSide, kPitch / 2 - static_cast<int>(kRadius * std::sqrt(ratio))))
          .setTo(kDark);
    EXPECT_NEAR(aspect_of(grey).ratio, ratio, 0.006);
  }
}

// What is seen at rims alone is light; what the distances of touching discs show too is the pixels.
TEST(RimAspect, IsDoubtedOnlyIfTheSpacingAgrees) {
  EXPECT_FALSE((Aspect{1.026, 0.002, {}}).doubt().empty());
  EXPECT_FALSE((Aspect{1.026, 0.002, 1.02}).doubt().empty());
  EXPECT_FALSE((Aspect{0.93, 0.002, 0.95}).doubt().empty());
  EXPECT_TRUE((Aspect{1.026, 0.002, 1.001}).doubt().empty());
  EXPECT_TRUE((Aspect{1.026, 0.002, 0.97}).doubt().empty());
  EXPECT_TRUE((Aspect{0.974, 0.002, 1.0}).doubt().empty());
}

TEST(RimAspect, OfTooFewDiscsIsAbsent) {
  RimAspect all;
  all.add(stretched(1.1, 1), {discs(kRadius)[0]});
  EXPECT_FALSE(all.value());
}

}  // namespace
}  // namespace twincell::imaging::rim_aspect_test
