// Variation of rims with direction, for outlines of which it is known.
#include "imaging/refine/rim_variation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "tests/unit/imaging/outlines.hpp"

namespace twincell::imaging::rim_variation_test {
namespace {

using namespace outlines;

/// All of one size.
double variation(const cv::Mat1f& grey, const std::vector<Detection>& of) {
  return rim_variation(grey, of, {kRadius});
}

TEST(RimVariation, ZeroForDiscsAtAnyNoise) {
  for (const double noise : {0.5, 5.0, 20.0})
    EXPECT_LT(variation(objects(circle, noise), discs(kRadius)), 0.006) << noise;
  // Centres that are off by half a pixel, as those of proposals.
  std::vector<Detection> off = discs(kRadius);
  for (Detection& d : off) d.x += 0.5;
  EXPECT_LT(variation(objects(circle, 2), off), 0.01);
}

// An outline R (1 + e cos m t) displaces the edge by e R cos m t; to first order the levels change in
// proportion to e, and their variance to e^2.
TEST(RimVariation, GrowsWithTheSquareOfTheHarmonic) {
  for (const int m : {3, 4, 5}) {
    const double less = variation(objects(wavy(0.03, m), 0.5), discs(kRadius)),
                 more = variation(objects(wavy(0.06, m), 0.5), discs(kRadius));
    EXPECT_NEAR(more / less, 4, 0.8) << m;
    EXPECT_LT(less, kMaxRimVariation) << m;
    EXPECT_GT(variation(objects(wavy(0.12, m), 0.5), discs(kRadius)), 1.5 * kMaxRimVariation) << m;
  }
}

TEST(RimVariation, TellsPolygonsFromDiscs) {
  EXPECT_GT(variation(objects(polygon(3, 0.9 * kRadius), 2), discs(kRadius)), 2 * kMaxRimVariation);
  EXPECT_GT(variation(objects(polygon(4, 0.9 * kRadius), 2), discs(kRadius)), kMaxRimVariation);
  EXPECT_LT(variation(objects(polygon(6, 0.9 * kRadius), 2), discs(kRadius)), kMaxRimVariation);
}

// Ellipses in random directions are not discs; those in one direction are stretched or moved discs.
TEST(RimVariation, LeavesOutWhatAllDiscsHaveInCommon) {
  const auto ellipse = [](double turn) {
    return kRadius / std::hypot(std::cos(turn) / 1.15, std::sin(turn) * 1.15);
  };
  const double apart = variation(objects(ellipse, 1), discs(kRadius)),
               alike = variation(objects(ellipse, 1, false), discs(kRadius));
  EXPECT_GT(apart, kMaxRimVariation);
  EXPECT_LT(alike, 0.3 * apart);
}

// Beads in contact with an opaque wall are as round as others. In a bed that fills its cell most of the rims
// that are seen are at walls.
TEST(RimVariation, LeavesOutWalls) {
  cv::Mat1f grey = objects(circle, 1);
  constexpr int kWall = kPitch / 2 - static_cast<int>(kRadius), kBlurred = 3;
  grey(cv::Rect(0, 0, kWall, kSide)).setTo(kDark);
  cv::Mat1b walls(grey.size(), uchar{0});
  walls(cv::Rect(0, 0, kWall + kBlurred, kSide)).setTo(255);
  std::vector<Detection> beside;
  for (const Detection& d : discs(kRadius))
    if (d.x < kPitch) beside.push_back(d);
  EXPECT_GT(rim_variation(grey, beside, {kRadius}), 2 * kMaxRimVariation);
  EXPECT_LT(rim_variation(grey, beside, {kRadius}, {}, walls), 0.01);
  // Polygons at a wall are still no discs.
  grey = objects(polygon(4, 0.85 * kRadius), 1);
  grey(cv::Rect(0, 0, kWall, kSide)).setTo(kDark);
  EXPECT_GT(rim_variation(grey, beside, {kRadius}, {}, walls), kMaxRimVariation);
}

TEST(RimVariation, ZeroForHiddenRims) {
  EXPECT_EQ(variation(objects(circle, 1), {}), 0);
  std::vector<Detection> hidden = discs(kRadius);
  for (const Detection& d : discs(kRadius)) {
    hidden.push_back(d);
    hidden.back().radius = 2 * kRadius;
  }
  EXPECT_EQ(variation(cv::Mat1f(kSide, kSide, 7.0F), hidden), 0);
}

// Fragments that are taken for a second size are not hidden by the discs of the first.
TEST(RimVariation, IsThatOfTheLeastRoundSize) {
  cv::Mat1f grey = objects(circle, 1);
  objects(polygon(3, 0.5 * kRadius), 1)(cv::Rect(0, 0, kSide, kPitch))
      .copyTo(grey(cv::Rect(0, 0, kSide, kPitch)));
  std::vector<Detection> both = discs(kRadius);
  for (std::size_t k = 0; k < both.size(); ++k)
    if (k < kSide / kPitch) both[k].radius = 0.6 * kRadius;
  EXPECT_LT(variation(grey, both), 0.01);
  EXPECT_GT(rim_variation(grey, both, {kRadius, 0.6 * kRadius}), 2 * kMaxRimVariation);
}

}  // namespace
}  // namespace twincell::imaging::rim_variation_test
