#pragma once
/// \file
/// A hexagonal lattice that extends beyond an image.

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <vector>

namespace twincell {

/// Sites of `rows` rows and columns on every side of (0, 0), row by row, rotated by the angle `turned`.
inline std::vector<cv::Point2d> hexagonal_sites(double constant, double turned, int rows) {
  std::vector<cv::Point2d> sites;
  for (int row = -rows; row <= rows; ++row)
    for (int column = -rows; column <= rows; ++column) {
      const double u = constant * (column + 0.5 * (row % 2)), v = 0.5 * std::numbers::sqrt3 * constant * row;
      sites.emplace_back(u * std::cos(turned) - v * std::sin(turned),
                         u * std::sin(turned) + v * std::cos(turned));
    }
  return sites;
}

}  // namespace twincell
