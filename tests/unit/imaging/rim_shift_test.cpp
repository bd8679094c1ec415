// Deviation of rims from circles, for outlines of which it is known.
#include "imaging/refine/rim_shift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "tests/unit/imaging/outlines.hpp"

namespace twincell::imaging::rim_shift_test {
namespace {

using namespace outlines;

/// All of one size.
double shift(const cv::Mat1f& grey, const std::vector<Detection>& of) {
  return rim_shift(of, picture_evidence(grey, of, {of.front().radius}).rims, {of.front().radius});
}

// r = R (1 + e cos m t) has the root mean square deviation e/sqrt 2; a sector of 2 pi/24 sees its mean, e
// sin(x)/x with x = m pi/24. To first order in e R over the blur, and for a few sectors in a period.
TEST(RimShift, IsThatOfAHarmonic) {
  for (const int m : {3, 4, 5, 6}) {
    constexpr double kShare = 0.04;
    const double x = m * std::numbers::pi / 24, expected = kShare / std::sqrt(2.0) * std::sin(x) / x;
    EXPECT_NEAR(shift(objects(wavy(kShare, m), 1), discs(kRadius)), expected, 0.1 * expected) << m;
  }
}

TEST(RimShift, ZeroForDiscsAtAnyNoise) {
  for (const double noise : {0.5, 5.0, 20.0})
    EXPECT_LT(shift(objects(circle, noise), discs(kRadius)), 0.002) << noise;
  // Centres that are off by half a pixel, and radii, as those of proposals.
  std::vector<Detection> off = discs(kRadius);
  for (Detection& d : off) d.x += 0.5;
  EXPECT_LT(shift(objects(circle, 2), off), 0.004);
  EXPECT_LT(shift(objects(circle, 2), discs(kRadius + 0.7)), 0.002);
}

TEST(RimShift, TellsPolygonsFromDiscs) {
  // The radius of the circle of the same area is 1.05 times the inner radius of a hexagon.
  EXPECT_GT(shift(objects(polygon(6, 0.95 * kRadius), 2), discs(kRadius)), kMaxRimShift);
  EXPECT_GT(shift(objects(polygon(4, 0.88 * kRadius), 2), discs(kRadius)), 2 * kMaxRimShift);
  EXPECT_LT(shift(objects(polygon(8, 0.97 * kRadius), 2), discs(kRadius)), kMaxRimShift);
}

// Ellipses in random directions are not discs; those in one direction are stretched or moved discs.
TEST(RimShift, LeavesOutWhatAllDiscsHaveInCommon) {
  EXPECT_GT(shift(objects(wavy(0.06, 2), 1), discs(kRadius)), kMaxRimShift);
  EXPECT_LT(shift(objects(wavy(0.06, 2), 1, false), discs(kRadius)), 0.3 * kMaxRimShift);
}

// The residuals of neighbours in contact, whose rims blur into each other, are no deviation.
TEST(RimShift, ZeroForTouchingDiscs) {
  constexpr double kPitchOfContacts = 12;
  cv::Mat1f grey(200, 200, 200.0F);
  std::vector<Detection> crystal;
  for (int row = 0; row < 14; ++row)
    for (int column = 0; column < 15; ++column) {
      Detection d;
      d.x = 12 + kPitchOfContacts * (column + 0.5 * (row % 2));
      d.y = 12 + kPitchOfContacts * std::sqrt(0.75) * row;
      d.radius = 0.5 * kPitchOfContacts;
      crystal.push_back(d);
    }
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 2);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      double level = 200;
      for (const Detection& d : crystal)
        level -= 85 * std::erfc((std::hypot(x - d.x, y - d.y) - d.radius) / std::numbers::sqrt2);
      grey(y, x) = static_cast<float>(level + normal(random));
    }
  EXPECT_LT(shift(grey, crystal), 0.25 * kMaxRimShift);
}

// A quarter of the discs suffices, however unlike discs the others are; less does not.
TEST(RimShift, AQuarterOfTheDiscsMustBeRound) {
  cv::Mat1f grey = objects(polygon(4, 0.88 * kRadius), 1);
  const cv::Mat1f round = objects(circle, 1);
  std::vector<Detection> many;
  std::vector<RimShift> rims;
  const auto add = [&](const cv::Mat1f& of, std::size_t times) {
    const std::vector<Detection> found = discs(kRadius);
    const PictureEvidence evidence = picture_evidence(of, found, {kRadius});
    for (std::size_t t = 0; t < times; ++t) {
      many.insert(many.end(), found.begin(), found.end());
      rims.insert(rims.end(), evidence.rims.begin(), evidence.rims.end());
    }
  };
  add(grey, 12);
  add(round, 8);
  EXPECT_LT(rim_shift(many, rims, {kRadius}), 0.25 * kMaxRimShift);
  add(grey, 60);
  EXPECT_GT(rim_shift(many, rims, {kRadius}), 2 * kMaxRimShift);
  // For the size that is the least round.
  std::vector<Detection> two = discs(kRadius);
  std::vector<RimShift> of_two = picture_evidence(round, two, {kRadius}).rims;
  for (Detection d : discs(kRadius)) {
    d.radius = 0.5 * kRadius;
    two.push_back(d);
  }
  const std::vector<RimShift> squares = picture_evidence(grey, discs(kRadius), {kRadius}).rims;
  of_two.insert(of_two.end(), squares.begin(), squares.end());
  EXPECT_GT(rim_shift(two, of_two, {kRadius, 0.5 * kRadius}), 2 * kMaxRimShift);
}

TEST(RimShift, ZeroForHiddenRims) {
  EXPECT_EQ(rim_shift({}, {}, {kRadius}), 0);
  for (const double noise : {0.5, 5.0, 20.0})
    EXPECT_LT(shift(objects([](double) { return 0.0; }, noise), discs(kRadius)), 0.2 * kMaxRimShift) << noise;
}

}  // namespace
}  // namespace twincell::imaging::rim_shift_test
