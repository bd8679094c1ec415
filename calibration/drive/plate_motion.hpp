#pragma once
/// \file
/// Harmonic fit of the plate's motion to measured heights.

#include <optional>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell::calibration {

/// Height `z` at time `t`, any units.
struct HeightSample {
  double time = 0;
  double height = 0;
};

/// Fitted motion z(t) = z0 + A sin(omega t + phi), A > 0, -pi < phi <= pi.
struct PlateMotion {
  double z0 = 0;
  double amplitude = 0;
  double omega = 0;
  double phase = 0;
  FitReport fit;               ///< parameters "z0", "A", "phi" and, if fitted, "omega"
  std::size_t n_left_out = 0;  ///< samples that were not finite
};

/// Fits the plate's motion (Fortini & Huang 2015, eq. 1, with a free origin and phase).
/// Samples that are not finite are left out and counted.
/// \param omega angular frequency in rad per time unit of the samples: known, or the start of the search.
/// With omega known the problem is linear in z0, A cos(phi), A sin(phi), and one step solves it.
/// \param fit_omega whether omega is a parameter too. The start must then be accurate to a fraction of 1/(2
/// duration), beyond which least squares has other minima.
/// \throws InputError for fewer samples than parameters, or omega not positive
PlateMotion fit_plate_motion(const std::vector<HeightSample>& samples, double omega, bool fit_omega = false);

}  // namespace twincell::calibration
