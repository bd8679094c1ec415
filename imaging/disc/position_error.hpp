#pragma once
/// \file
/// Standard uncertainty of a detection's position as one number.

#include <cmath>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// trackpy's `ep`: root mean square of sigma_x and sigma_y, px.
[[nodiscard]] inline double position_error(const Detection& d) {
  return std::sqrt(0.5 * (d.sigma_x * d.sigma_x + d.sigma_y * d.sigma_y));
}

}  // namespace twincell::imaging
