#include "imaging/refine/residual_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <random>

namespace twincell::imaging::residual_correlation_test {
namespace {

constexpr double kRadius = 9, kWidth = 0.9, kDeviation = 0.02;

/// Residuals, and discs on a square lattice.
struct Residuals {
  cv::Mat1f picture, model;
  std::vector<Disc> discs;
  RingArgs args;
};

/// \param length_px of the Gaussian that smooths independent residuals; 0: none
void fill(Residuals& r, double length_px, std::uint64_t seed, int discs_a_side = 20) {
  const int pitch = 26, side = discs_a_side * pitch;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, kDeviation);
  r.picture.create(side, side + kSpareColumns);
  for (float& v : r.picture) v = static_cast<float>(normal(random));
  if (length_px > 0) {
    cv::GaussianBlur(r.picture, r.picture, {0, 0}, length_px);
    r.picture *= 2 * std::sqrt(3.141592653589793) * length_px;  // the same variance as before
  }
  r.model = cv::Mat1f::zeros(r.picture.size());
  for (int i = 0; i < discs_a_side; ++i)
    for (int j = 0; j < discs_a_side; ++j)
      r.discs.push_back({pitch * (i + 0.5) + 0.013 * j, pitch * (j + 0.5) - 0.017 * i, kRadius, 1});
  r.args.picture = &r.picture, r.args.model = &r.model;
  r.args.blur.variance = kWidth * kWidth;
  r.args.ring = 3 * kWidth;
  r.args.dark_variance = kDeviation * kDeviation, r.args.light_variance = 0;
  r.args.huber = 1;
}

/// Power of the residuals in cos phi and sin phi, weighted by the slope of the edge, over that of independent
/// ones: the variance of a centre that is fitted to them.
double power_of_centres(const Residuals& r) {
  double power = 0;
  for (const Disc& disc : r.discs) {
    double s[2] = {}, e[2] = {};
    for (int y = 0; y < r.picture.rows; ++y) {
      if (std::abs(y - disc.y) > kRadius + r.args.ring) continue;
      for (int x = 0; x < r.picture.cols - kSpareColumns; ++x) {
        const double dx = x - disc.x, dy = y - disc.y, distance = std::hypot(dx, dy);
        if (std::abs(distance - kRadius) > r.args.ring) continue;
        const double u = distance - kRadius + 0.5 * kWidth * kWidth / kRadius;
        const double slope = std::exp(-0.5 * u * u / (kWidth * kWidth));
        const double by[2] = {slope * dx / distance, slope * dy / distance};
        for (int k = 0; k < 2; ++k)
          s[k] += by[k] * static_cast<double>(r.picture(y, x)), e[k] += by[k] * by[k];
      }
    }
    for (int k = 0; k < 2; ++k) power += s[k] * s[k] / e[k] / (kDeviation * kDeviation);
  }
  return power / (2.0 * static_cast<double>(r.discs.size()));
}

double correlation(const Residuals& r, double excess = 1) {
  return residual_correlation(rim_harmonics(r.args, r.discs, std::vector<double>(r.discs.size(), excess)));
}

TEST(ResidualCorrelation, IndependentResidualsHaveNone) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    Residuals r;
    fill(r, 0, seed);
    EXPECT_EQ(correlation(r), 1) << seed;
    EXPECT_NEAR(power_of_centres(r), 1, 0.15) << seed;
  }
}

// The first harmonic is measured here, because no fit has absorbed it.
TEST(ResidualCorrelation, HigherHarmonicsTellTheVarianceOfCentres) {
  for (const double length : {0.7, 1.0, 2.0, 3.0, 5.0}) {
    Residuals r;
    fill(r, length, 7);
    const double rho = correlation(r), centres = power_of_centres(r);
    std::printf("residuals alike over %g px: rho %.2f, variance of centres %.2f\n", length, rho, centres);
    EXPECT_GT(centres, 2);
    EXPECT_NEAR(rho / centres, 1, 0.35) << length;
  }
}

TEST(ResidualCorrelation, IsRelativeToTheSizeOfTheResiduals) {
  Residuals r;
  fill(r, 1.5, 3);
  EXPECT_NEAR(correlation(r, 2), 0.5 * correlation(r, 1), 1e-9);
  EXPECT_EQ(correlation(r, 1e3), 1);
}

// Motion during the exposure, or stretched pixels, change all rims in the same way.
TEST(ResidualCorrelation, WhatAllDiscsShareDoesNotCount) {
  Residuals r;
  fill(r, 0, 5);
  for (const Disc& disc : r.discs)
    for (int y = cvRound(disc.y) - 13; y < cvRound(disc.y) + 13; ++y)
      for (int x = cvRound(disc.x) - 13; x < cvRound(disc.x) + 13; ++x) {
        if (y < 0 || x < 0 || y >= r.picture.rows || x >= r.picture.cols - kSpareColumns) continue;
        const double dx = x - disc.x, dy = y - disc.y, u = std::hypot(dx, dy) - kRadius;
        r.picture(y, x) += static_cast<float>(0.05 * std::exp(-0.5 * u * u) * (dx * dx - dy * dy) /
                                              std::max(1.0, dx * dx + dy * dy));
      }
  EXPECT_EQ(correlation(r), 1);
}

TEST(ResidualCorrelation, FewOrHiddenDiscsGiveNone) {
  Residuals few;
  fill(few, 2, 1, 3);
  EXPECT_EQ(correlation(few), 1);
  Residuals hidden;
  fill(hidden, 2, 1);
  EXPECT_GT(correlation(hidden), 3);
  for (int y = 0; y < hidden.picture.rows; ++y) hidden.picture(y, y) = kUnseen;
  const std::size_t whole =
      rim_harmonics(hidden.args, hidden.discs, std::vector<double>(hidden.discs.size(), 1)).size();
  EXPECT_LT(whole, hidden.discs.size());
  hidden.picture.setTo(kUnseen);
  EXPECT_EQ(correlation(hidden), 1);
}

}  // namespace
}  // namespace twincell::imaging::residual_correlation_test
