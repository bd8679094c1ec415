#pragma once
/// \file
/// Objects of a known outline on a lattice, for tests of roundness.

#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging::outlines {

inline constexpr int kSide = 240, kPitch = 60;
inline constexpr double kLight = 200, kDark = 30, kBlur = 1, kRadius = 14;

/// Dark objects on a lattice with the outline r(direction), each turned differently, drawn with 4 x 4 samples
/// per pixel, blurred, and with noise.
inline cv::Mat1f objects(const std::function<double(double)>& outline, double noise, bool turned = true) {
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

/// A disc of a radius at each object.
inline std::vector<Detection> discs(double radius) {
  std::vector<Detection> all;
  for (int row = 0; row < kSide / kPitch; ++row)
    for (int column = 0; column < kSide / kPitch; ++column) {
      Detection d;
      d.x = (column + 0.5) * kPitch, d.y = (row + 0.5) * kPitch, d.radius = radius;
      all.push_back(d);
    }
  return all;
}

inline double circle(double /*turn*/) {
  return kRadius;
}

/// A regular polygon. \param inner radius of the circle that it encloses
inline std::function<double(double)> polygon(int sides, double inner) {
  return [sides, inner](double turn) {
    const double part = 2 * std::numbers::pi / sides, t = turn - part * std::floor(turn / part);
    return inner / std::cos(t - 0.5 * part);
  };
}

/// The outline R (1 + share cos(m t)).
inline std::function<double(double)> wavy(double share, int m) {
  return [share, m](double turn) { return kRadius * (1 + share * std::cos(m * turn)); };
}

}  // namespace twincell::imaging::outlines
