// Stated errors of discs before a textured background, whose residuals are alike over several pixels
// (residual_correlation.hpp).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::texture_test {
namespace {

/// A smooth random field with standard deviation 1. \param length_px of the Gaussian that smooths it; 0: none
cv::Mat1f field(int side, double length_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  cv::Mat1f values(side, side);
  for (float& v : values) v = normal(random);
  if (length_px > 0) cv::GaussianBlur(values, values, {0, 0}, length_px, 0, cv::BORDER_REFLECT);
  cv::Scalar mean, deviation;
  cv::meanStdDev(values, mean, deviation);
  return (values - mean[0]) / deviation[0];
}

/// Root mean square of the errors of the centres, divided by the stated ones.
double pull(double diameter, double length_px, const char* method, bool touching = false) {
  double squares = 0, n = 0;
  for (const std::uint64_t seed : {1U, 2U}) {
    const int side = side_of(diameter);
    const cv::Rect2d room(0, 0, side, side);
    const Places places = touching ? at_rest(diameter, room, 0.7, seed) : apart(diameter, room, 1.4, seed);
    const cv::Mat1f texture = field(side, std::max(0.5, length_px), 10 + seed);
    Painter canvas(side, kLight);
    if (length_px > 0)
      canvas.everywhere([&](double x, double y, double below) {
        const auto row = std::clamp(static_cast<int>(std::lround(y)), 0, side - 1),
                   column = std::clamp(static_cast<int>(std::lround(x)), 0, side - 1);
        return below * (1 + 0.06 * static_cast<double>(texture(row, column)));
      });
    for (const Place& p : places)
      canvas.disc(p.x, p.y, p.radius, [](double, double, double) { return kBlack; });
    imaging::LocatorOptions options;
    options.diameter_px = diameter;
    options.refine.method = method;
    for (const imaging::Detection& b : imaging::locate(canvas.exposed(kBlur, kNoise, seed), options).beads)
      for (const Place& p : places)
        if (std::hypot(b.x - p.x, b.y - p.y) < 0.2 * diameter) {
          squares += std::pow((b.x - p.x) / b.sigma_x, 2) + std::pow((b.y - p.y) / b.sigma_y, 2);
          n += 2;
        }
  }
  EXPECT_GT(n, 150);
  return std::sqrt(squares / n);
}

TEST(Texture, StatedErrorsGrowWithWhatItLeaves) {
  for (const char* method : {"exact", "profile", "overlapping"})
    for (const double diameter : {12.0, 20.0, 32.0})
      for (const double length : {0.0, 1.0, 2.0, 4.0}) {
        const double errors = pull(diameter, length, method);
        std::printf("%-11s %2g px, texture of %g px: %.2f stated errors\n", method, diameter, length, errors);
        EXPECT_GT(errors, 0.75) << method << ' ' << diameter << ' ' << length;
        EXPECT_LT(errors, 1.35) << method << ' ' << diameter << ' '
                                << length;  // 1.9 to 4.4 if pixels were independent
      }
}

// Small beads that touch absorb harmonics of their neighbours, and a light that varies over more than a bead
// leaves none.
TEST(Texture, StatedErrorsRemainTooSmallForSmallTouchingBeadsAndWideTexture) {
  const double touching = pull(10, 2, "exact", true), wide = pull(16, 16, "exact");
  std::printf("touching beads of 10 px, texture of 2 px: %.2f stated errors\n", touching);
  std::printf("beads of 16 px, texture of 16 px: %.2f stated errors\n", wide);
  EXPECT_GT(touching, 1.1);
  EXPECT_LT(touching, 2);
  EXPECT_GT(wide, 1.3);
  EXPECT_LT(wide, 3.2);
}

}  // namespace
}  // namespace twincell::zoo::texture_test
