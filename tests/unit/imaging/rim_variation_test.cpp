// Variation of rims with direction, for outlines of which it is known.
#include "imaging/refine/rim_variation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

namespace twincell::imaging {
namespace {

constexpr int kSide = 240, kPitch = 60;
constexpr double kLight = 200, kDark = 30, kBlur = 1, kRadius = 14;

/// Dark objects on a lattice with the outline r(direction), each turned differently, drawn with 4 x 4 samples
/// per pixel, blurred, and with noise.
cv::Mat1f objects(const std::function<double(double)>& outline, double noise, bool turned = true) {
  constexpr int kSamples = 4;
  cv::Mat1f fine(kSide * kSamples, kSide * kSamples, static_cast<float>(kLight));
  for (int j = 0; j < fine.rows; ++j)
    for (int i = 0; i < fine.cols; ++i) {
      const double x = (i + 0.5) / kSamples - 0.5, y = (j + 0.5) / kSamples - 0.5;
      const int column = static_cast<int>(x / kPitch), row = static_cast<int>(y / kPitch);
      const double dx = x - (column + 0.5) * kPitch, dy = y - (row + 0.5) * kPitch;
      const double turn = std::atan2(dy, dx) + (turned ? column + 4 * row : 0);
      if (std::hypot(dx, dy) < outline(turn)) fine(j, i) = static_cast<float>(kDark);
    }
  cv::GaussianBlur(fine, fine, {0, 0}, kBlur * kSamples);
  cv::Mat1f grey;
  cv::resize(fine, grey, {kSide, kSide}, 0, 0, cv::INTER_AREA);
  std::mt19937_64 random(5);
  std::normal_distribution<float> normal(0, static_cast<float>(noise));
  for (float& v : grey) v += normal(random);
  return grey;
}

/// All of one size.
double variation(const cv::Mat1f& grey, const std::vector<Detection>& of) {
  return rim_variation(grey, of, {kRadius});
}

std::vector<Detection> discs(double radius) {
  std::vector<Detection> all;
  for (int row = 0; row < kSide / kPitch; ++row)
    for (int column = 0; column < kSide / kPitch; ++column) {
      Detection d;
      d.x = (column + 0.5) * kPitch, d.y = (row + 0.5) * kPitch, d.radius = radius;
      all.push_back(d);
    }
  return all;
}

double circle(double /*turn*/) {
  return kRadius;
}

TEST(RimVariation, OfDiscsIsNoneWithAnyNoise) {
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
  const auto wavy = [](double share, int m) {
    return [share, m](double turn) { return kRadius * (1 + share * std::cos(m * turn)); };
  };
  for (const int m : {3, 4, 5}) {
    const double less = variation(objects(wavy(0.03, m), 0.5), discs(kRadius)),
                 more = variation(objects(wavy(0.06, m), 0.5), discs(kRadius));
    EXPECT_NEAR(more / less, 4, 0.8) << m;
    EXPECT_LT(less, kMostRimVariation) << m;
    EXPECT_GT(variation(objects(wavy(0.12, m), 0.5), discs(kRadius)), 1.5 * kMostRimVariation) << m;
  }
}

TEST(RimVariation, TellsPolygonsFromDiscs) {
  const auto polygon = [](int sides) {
    return [sides](double turn) {
      const double part = 2 * std::numbers::pi / sides, t = turn - part * std::floor(turn / part);
      return 0.9 * kRadius / std::cos(t - 0.5 * part);
    };
  };
  EXPECT_GT(variation(objects(polygon(3), 2), discs(kRadius)), 2 * kMostRimVariation);
  EXPECT_GT(variation(objects(polygon(4), 2), discs(kRadius)), kMostRimVariation);
  EXPECT_LT(variation(objects(polygon(6), 2), discs(kRadius)), kMostRimVariation);
}

// Ellipses in random directions are not discs; those in one direction are stretched or moved discs.
TEST(RimVariation, LeavesOutWhatAllDiscsHaveInCommon) {
  const auto ellipse = [](double turn) {
    return kRadius / std::hypot(std::cos(turn) / 1.15, std::sin(turn) * 1.15);
  };
  const double apart = variation(objects(ellipse, 1), discs(kRadius)),
               alike = variation(objects(ellipse, 1, false), discs(kRadius));
  EXPECT_GT(apart, kMostRimVariation);
  EXPECT_LT(alike, 0.3 * apart);
}

TEST(RimVariation, OfRimsThatAreNotSeenIsNone) {
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
  const auto triangle = [](double turn) {
    const double part = 2 * std::numbers::pi / 3, t = turn - part * std::floor(turn / part);
    return 0.5 * kRadius / std::cos(t - 0.5 * part);
  };
  cv::Mat1f grey = objects(circle, 1);
  objects(triangle, 1)(cv::Rect(0, 0, kSide, kPitch)).copyTo(grey(cv::Rect(0, 0, kSide, kPitch)));
  std::vector<Detection> both = discs(kRadius);
  for (std::size_t k = 0; k < both.size(); ++k)
    if (k < kSide / kPitch) both[k].radius = 0.6 * kRadius;
  EXPECT_LT(variation(grey, both), 0.01);
  EXPECT_GT(rim_variation(grey, both, {kRadius, 0.6 * kRadius}), 2 * kMostRimVariation);
}

}  // namespace
}  // namespace twincell::imaging
