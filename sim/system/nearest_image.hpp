#pragma once
/// \file
/// Nearest periodic image along one axis.

#include <cmath>

namespace twincell::sim {

/// The nearest integer, the even one at a tie, for |x| < 2^51. Adding 1.5 2^52 rounds without the function
/// call of std::round.
inline double nearest_whole(double x) {
  constexpr double kRounds = 6755399441055744.0;
  return (x + kRounds) - kRounds;
}

/// Shift to the nearest periodic image, in the unit of r: r + nearest_shift(r, period) is the separation of
/// smallest magnitude. Period 0: not periodic.
inline double nearest_shift(double r, double period) {
  return period > 0 && 2 * std::abs(r) >= period ? -period * nearest_whole(r / period) : 0;
}

}  // namespace twincell::sim
