// The residual illumination, found from the means of coarse tiles.

#include "imaging/preprocess/residual_illumination.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace twincell::imaging::residual_illumination_test {
namespace {

constexpr double kNoise = 0.01;  // standard deviation of a tile's mean
constexpr int kWide = 16, kHigh = 24;

struct Tiles {
  cv::Mat1d mean = cv::Mat1d::zeros(kHigh, kWide), variance = mean.clone();
};

/// A wave of the given amplitude with a wavelength of nine tiles horizontally and twelve tiles vertically.
double wave(double amplitude, int x, int y) {
  return amplitude * std::sin(2 * M_PI * x / 9.0 + 1) * std::cos(2 * M_PI * y / 12.0);
}

Tiles tiles_of(double amplitude, std::uint64_t seed) {
  Tiles t;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, kNoise);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      t.mean(y, x) = wave(amplitude, x, y) + normal(random);
      t.variance(y, x) = kNoise * kNoise;
    }
  return t;
}

double rms_error(const cv::Mat1f& map, double amplitude) {
  double squares = 0;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x)
      squares += std::pow(static_cast<double>(map(y, x)) - wave(amplitude, x, y), 2);
  return std::sqrt(squares / (kWide * kHigh));
}

TEST(ResidualIllumination, IsSeenWhereThereIsOne) {
  int by_chance = 0, seen = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Tiles noise = tiles_of(0, seed), rippled = tiles_of(2 * kNoise, seed);
    by_chance += has_ripple(noise.mean, noise.variance);
    seen += has_ripple(rippled.mean, rippled.variance);
  }
  EXPECT_EQ(by_chance, 0);
  EXPECT_EQ(seen, 200);
}

// A misplaced disc changes only its own tile, even by fifty times the noise.
TEST(ResidualIllumination, IgnoresSingleTileResidual) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Tiles t = tiles_of(0, seed);
    t.mean(7, 5) = 50 * kNoise;
    t.mean(12, 9) = -50 * kNoise;
    EXPECT_FALSE(has_ripple(t.mean, t.variance));
  }
}

// A fit of a wave with a dozen crests to 384 noisy tiles passes a fraction of the noise, given by its degrees
// of freedom: less than half, more than a tenth.
TEST(ResidualIllumination, IsFoundBelowTheNoiseOfATile) {
  for (const double amplitude : {0.03, 0.3}) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Tiles t = tiles_of(amplitude, seed);
      squares += std::pow(rms_error(smooth_ripple(t.mean, t.variance), amplitude), 2) / 10;
    }
    const double error = std::sqrt(squares);
    std::printf("amplitude %g: error %.5f, of a tile's mean %.5f\n", amplitude, error, kNoise);
    EXPECT_GE(error, std::sqrt(0.1) * kNoise);
    EXPECT_LE(error, (amplitude < 0.1 ? std::sqrt(0.5) : 1) * kNoise);
  }
}

TEST(ResidualIllumination, FollowsItsNeighboursWhereNothingIsSeen) {
  Tiles t = tiles_of(0.1, 3);
  for (const cv::Point hole : {cv::Point(4, 4), cv::Point(10, 15), cv::Point(11, 15)}) {
    t.mean(hole) = 0;
    t.variance(hole) = std::numeric_limits<double>::infinity();
  }
  const cv::Mat1f map = smooth_ripple(t.mean, t.variance);
  for (const cv::Point hole : {cv::Point(4, 4), cv::Point(10, 15), cv::Point(11, 15)})
    EXPECT_NEAR(static_cast<double>(map(hole)), wave(0.1, hole.x, hole.y), 0.03);
}

// For a tilted plane, extrapolation would continue the slope beyond the last visible tile; the map of the
// illumination must not.
TEST(ResidualIllumination, DoesNotExtrapolate) {
  Tiles t = tiles_of(0, 1);
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      t.mean(y, x) = 0.1 * y;
      if (y >= kHigh / 2) t.mean(y, x) = 0, t.variance(y, x) = std::numeric_limits<double>::infinity();
    }
  const cv::Mat1f map = smooth_ripple(t.mean, t.variance);
  EXPECT_NEAR(static_cast<double>(map(5, 5)), 0.5, 0.01);
  EXPECT_NEAR(static_cast<double>(map(kHigh - 1, 5)), 0.1 * (kHigh / 2 - 1), 0.01);
}

}  // namespace
}  // namespace twincell::imaging::residual_illumination_test
