// Evidence of a picture for a set of discs, on pictures whose evidence is known.
#include "imaging/refine/picture_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace twincell::imaging::picture_evidence_test {
namespace {

constexpr double kRadius = 15, kNoise = 1, kOutside = 2.5;
constexpr int kSide = 200;

/// Cones in noise: the darkness falls linearly from the centre to 2.5 px outside the rim, a profile that the
/// model represents exactly.
cv::Mat1f cones(const std::vector<cv::Point2d>& centres) {
  cv::Mat1f grey(kSide, kSide, 200.0F);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, kNoise);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      double level = 200 + normal(random);
      for (const cv::Point2d& c : centres)
        level -= 8 * std::max(0.0, kRadius + kOutside - std::hypot(x - c.x, y - c.y));
      grey(y, x) = static_cast<float>(level);
    }
  return grey;
}

std::vector<Detection> discs_at(const std::vector<cv::Point2d>& centres, double radius) {
  std::vector<Detection> discs;
  for (const cv::Point2d& c : centres) {
    Detection d;
    d.x = c.x, d.y = c.y, d.radius = radius;
    discs.push_back(d);
  }
  return discs;
}

const std::vector<cv::Point2d> kCentres = {{50, 50}, {140, 60}, {60, 140}, {145, 150}};

// For an exact model e_1 is the noise, so a pixel gains ln(s_1/s_0) + ln(s_0^2 + e_0^2) - ln(s_1^2 + e_1^2),
// and the mean of ln(1 + z^2) of a normal z is 0.5335 (numerical integration).
TEST(PictureEvidence, OfAnExactModelIsItsClosedForm) {
  const cv::Mat1f grey = cones(kCentres);
  const double s0 = noise_level(grey);  // without discs; with them the scale is that of the residuals
  double expected = 0;
  for (const cv::Point2d& c : kCentres)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (std::hypot(x - c.x, y - c.y) > kRadius + kOutside) continue;
        double least = HUGE_VAL;
        for (int k = 0; k < 8; ++k) {
          const double turn = std::numbers::pi * k / 8, far = 0.5 * kRadius;
          const int dx = cvRound(far * std::cos(turn)), dy = cvRound(far * std::sin(turn));
          double squares = 0;
          for (const int times : {-2, -1, 1, 2}) {
            const double e = static_cast<double>(grey(y + times * dy, x + times * dx) - grey(y, x));
            squares += e * e / 8;
          }
          least = std::min(least, squares);
        }
        expected += std::log((s0 * s0 + least) / (s0 * kNoise)) - 0.5335;
      }
  const double discs = static_cast<double>(kCentres.size()), pixels = std::log(double(kSide) * kSide);
  const double of_disc = std::log(std::numbers::pi * std::pow(kRadius + kOutside, 2));
  expected -= discs * (2.5 * of_disc + 1 + pixels - std::log(discs));
  expected -= 0.5 * 2 * (kRadius + kOutside) * pixels;
  const PictureEvidence found = picture_evidence(grey, discs_at(kCentres, kRadius), {kRadius});
  EXPECT_NEAR(found.total, expected, 0.01 * expected);
  for (const double of : found.of_disc) EXPECT_NEAR(of, found.total / discs, 0.1 * found.total / discs);
}

// A disc less is the share of a disc less; a disc where none is costs its parameters and its place at least.
TEST(PictureEvidence, FallsForMissingAndForSurplusDiscs) {
  const cv::Mat1f grey = cones(kCentres);
  const PictureEvidence all = picture_evidence(grey, discs_at(kCentres, kRadius), {kRadius});
  const PictureEvidence less =
      picture_evidence(grey, discs_at({kCentres[0], kCentres[1], kCentres[2]}, kRadius), {kRadius});
  EXPECT_NEAR(all.total - less.total, all.of_disc[3], 0.05 * all.of_disc[3]);
  std::vector<cv::Point2d> more = kCentres;
  more.emplace_back(100, 100);
  const PictureEvidence invented = picture_evidence(grey, discs_at(more, kRadius), {kRadius});
  EXPECT_LT(invented.of_disc[4], -2.5 * std::log(std::numbers::pi * std::pow(kRadius + kOutside, 2)) - 1 -
                                     std::log(double(kSide) * kSide / 5));
  EXPECT_LT(invented.total, all.total + invented.of_disc[4] + 0.05 * all.total / 4);
  EXPECT_GT(invented.misfit[4], invented.misfit[0]);
}

// The true discs have all that is possible but the cost of their parameters, and not all discs do not, nor do
// small discs in the middle of large ones, at distances at which the rims of the large ones seem straight.
TEST(PictureEvidence, OfTheTrueDiscsIsNearlyThePossible) {
  const cv::Mat1f grey = cones(kCentres);
  const double possible = possible_evidence(grey, kRadius);
  const double of_all = picture_evidence(grey, discs_at(kCentres, kRadius), {kRadius}, kRadius).total;
  EXPECT_GT(of_all, 0.9 * possible);
  EXPECT_LT(of_all, possible);
  EXPECT_LT(picture_evidence(grey, discs_at({kCentres[0], kCentres[1]}, kRadius), {kRadius}, kRadius).total,
            0.55 * possible);
  EXPECT_LT(picture_evidence(grey, discs_at(kCentres, 4), {4}, kRadius).total, 0.5 * possible);
  EXPECT_EQ(possible_evidence(cv::Mat1f(0, 0), kRadius), 0);
}

// The true discs leave the noise; a missing disc leaves itself; one that is moved by 1 px leaves a dipole of
// the slope of its profile, 8 levels a px.
TEST(PictureEvidence, ResidualsShowWhatTheDiscsLeave) {
  const cv::Mat1f grey = cones(kCentres);
  const auto mean_in = [](const cv::Mat1f& picture, const cv::Point2d& c, double dx, double power) {
    double sum = 0, n = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double far = std::hypot(x - c.x, y - c.y);
        if (far > kRadius - 2 || far < 4 || (x - c.x) * dx < 0.7 * far * std::abs(dx)) continue;
        sum += std::pow(static_cast<double>(picture(y, x)), power), ++n;
      }
    return sum / n;
  };
  const cv::Mat1f left = residual_picture(grey, discs_at(kCentres, kRadius), {kRadius});
  for (const cv::Point2d& c : kCentres) EXPECT_NEAR(std::sqrt(mean_in(left, c, 0, 2)), kNoise, 0.15 * kNoise);
  std::vector<cv::Point2d> others = kCentres;
  others[1].x += 1;
  others.pop_back();
  const cv::Mat1f other = residual_picture(grey, discs_at(others, kRadius), {kRadius});
  EXPECT_GT(std::sqrt(mean_in(other, kCentres[3], 0, 2)), 10 * kNoise);
  EXPECT_NEAR(mean_in(other, kCentres[1], 1, 1), 8 * 0.85, 2);
  EXPECT_NEAR(mean_in(other, kCentres[1], -1, 1), -8 * 0.85, 2);
  EXPECT_TRUE(residual_picture(cv::Mat1f(0, 0), {}, {kRadius}).empty());
  EXPECT_EQ(residual_picture(grey, {}, {kRadius}).size(), grey.size());
}

// Discs of another size or place lose.
TEST(PictureEvidence, IsLargestForTheTrueDiscs) {
  const cv::Mat1f grey = cones(kCentres);
  const double best = picture_evidence(grey, discs_at(kCentres, kRadius), {kRadius}).total;
  std::vector<cv::Point2d> moved = kCentres;
  for (cv::Point2d& c : moved) c.x += 1;
  EXPECT_LT(picture_evidence(grey, discs_at(moved, kRadius), {kRadius}).total, 0.8 * best);
  EXPECT_LT(picture_evidence(grey, discs_at(kCentres, 0.6 * kRadius), {0.6 * kRadius}).total, 0.8 * best);
}

// Discs inside a straight dark strip: the neighbourhood describes its edges, so the discs gain nothing.
TEST(PictureEvidence, HasNoDiscsInAStrip) {
  cv::Mat1f grey(kSide, kSide, 200.0F);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, kNoise);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      grey(y, x) = static_cast<float>((std::abs(y - 100) < 7.5 ? 30 : 200) + normal(random));
  std::vector<cv::Point2d> chain;
  for (int x = 10; x < kSide - 10; x += 15) chain.emplace_back(x, 100);
  EXPECT_LT(picture_evidence(grey, discs_at(chain, 7.5), {7.5}).total, 0);
}

TEST(PictureEvidence, GainOfAPixel) {
  EXPECT_DOUBLE_EQ(pixel_gain(0, 2, 6, 2), std::log(10.0));
  EXPECT_DOUBLE_EQ(pixel_gain(6, 2, 0, 2), -std::log(10.0));
  EXPECT_DOUBLE_EQ(pixel_gain(0, 4, 0, 2), -std::log(2.0));
}

TEST(PictureEvidence, NoiseLevelIsThatOfThePicture) {
  EXPECT_NEAR(noise_level(cones(kCentres)), kNoise, 0.1);
  EXPECT_EQ(picture_evidence(cones({}), {}, {kRadius}).total, 0);
}

}  // namespace
}  // namespace twincell::imaging::picture_evidence_test
