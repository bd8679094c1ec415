// The Cramér-Rao bound of rendered pictures, against the Fisher information from finite differences of whole
// pictures and against the closed form of a straight edge; packings whose discs touch but do not overlap.

#include "imaging/benchmark/cramer_rao_bound.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <random>

#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/picture.hpp"

namespace twincell::imaging::rendered::cramer_rao_bound_test {
namespace {

/// The bound with x, y, R and a of all discs free at the same time; derivatives from finite differences of
/// pictures.
std::vector<double> bound_by_differences(const Picture& picture, double snr) {
  constexpr double kStep = 1e-3;
  const auto n = static_cast<Eigen::Index>(picture.discs.size());
  const cv::Mat1d level = expected(picture);
  const auto pixels = static_cast<Eigen::Index>(level.total());
  Eigen::MatrixXd gradient(pixels, 4 * n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (int q = 0; q < 4; ++q) {
      Picture up = picture, down = picture;
      for (auto [p, step] : {std::pair{&up, kStep}, std::pair{&down, -kStep}}) {
        Disc& d = p->discs[static_cast<std::size_t>(k)];
        (q == 0 ? d.x : q == 1 ? d.y : q == 2 ? d.radius : d.contrast) += step;
      }
      const cv::Mat1d a = expected(up), b = expected(down);
      for (Eigen::Index i = 0; i < pixels; ++i)
        gradient(i, 4 * k + q) = (a(static_cast<int>(i)) - b(static_cast<int>(i))) / (2 * kStep);
    }
  const double noise = picture.light / snr, slope = noise * noise * (1 - kReadShare) / picture.light;
  Eigen::VectorXd weight(pixels);
  for (Eigen::Index i = 0; i < pixels; ++i) {
    const double light = std::max(0.0, level(static_cast<int>(i)) - picture.pedestal);
    const double v = noise * noise * kReadShare + slope * light + 1.0 / 12;
    weight[i] = 1 / v + 0.5 * slope * slope / (v * v);
  }
  const Eigen::MatrixXd covariance = (gradient.transpose() * weight.asDiagonal() * gradient).inverse();
  std::vector<double> bound;
  for (Eigen::Index k = 0; k < n; ++k)
    bound.push_back(std::sqrt(0.5 * (covariance(4 * k, 4 * k) + covariance(4 * k + 1, 4 * k + 1))));
  return bound;
}

TEST(CramerRaoBound, MatchesNumericalFisherInformation) {
  std::mt19937_64 random(5);
  Picture p;
  p.width = p.height = 80;
  p.discs = deposited(std::vector<double>(12, 7.5), {10.3, 5, 60, 64.6}, random);
  for (const double snr : {164.0, 18.5}) {
    const auto all = bound_by_differences(p, snr), own = cramer_rao_bound(expected(p), p, snr);
    for (std::size_t k = 0; k < all.size(); ++k) {
      // The bound takes the neighbours of the neighbours as known: it may be slightly smaller, never larger.
      EXPECT_GE(own[k], all[k] * (1 - 1e-2)) << k;
      EXPECT_LE(own[k], all[k] * (1 + 1e-4)) << k;
    }
  }
}

// For a large disc the edge is straight, and (dI/dx)^2 averages to half of its square along the rim.
TEST(CramerRaoBound, LargeDiscApproachesAStraightEdge) {
  Picture p;
  p.width = p.height = 140;
  p.discs = {{.x = 70.3, .y = 69.8, .radius = 50}};
  const double snr = 51, noise = p.light / snr, slope = noise * noise * (1 - kReadShare) / p.light;
  const double s = std::sqrt(p.blur * p.blur + 1.0 / 12);  // the width of a pixel adds its variance
  double information = 0;
  constexpr double kStep = 1e-3;
  for (double u = -8; u < 8; u += kStep) {
    const double light = p.light * 0.5 * std::erfc(-u / (std::sqrt(2.0) * s));
    const double edge = p.light * std::exp(-0.5 * u * u / (s * s)) / (std::sqrt(2 * M_PI) * s);
    const double v = noise * noise * kReadShare + slope * light + 1.0 / 12;
    information += kStep * M_PI * 50 * edge * edge * (1 / v + 0.5 * slope * slope / (v * v));
  }
  const double bound = cramer_rao_bound(expected(p), p, snr)[0];
  std::printf("disc of 100 px, SNR 51: bound %.6f px, straight edge %.6f px\n", bound,
              1 / std::sqrt(information));
  EXPECT_NEAR(bound * std::sqrt(information), 1, 0.01);
}

TEST(Packing, DepositedDiscsTouchAndDoNotOverlap) {
  std::mt19937_64 random(6);
  const auto discs = deposited(std::vector<double>(300, 7.5), {0, 0, 300, 600}, random);
  ASSERT_EQ(discs.size(), 300U);
  int contacts = 0;
  for (std::size_t k = 0; k < discs.size(); ++k)
    for (std::size_t j = 0; j < k; ++j) {
      const double gap = std::hypot(discs[k].x - discs[j].x, discs[k].y - discs[j].y) - 15;
      EXPECT_GE(gap, -1e-4);
      contacts += gap < 1e-4;
    }
  // Each disc comes to rest on two others, on one disc and a wall, or on the floor; a few also touch a third.
  EXPECT_GE(contacts, 500);
  EXPECT_LE(contacts, 630);
}

}  // namespace
}  // namespace twincell::imaging::rendered::cramer_rao_bound_test
