#pragma once
/// \file
/// Normal restitution e_n of bead and plate from the filmed heights of a bead that bounces on the plate,
/// which is at rest or vibrates.
///
/// Between two impacts the bead follows a free flight with linear drag:
///     dv/dt = -g - d v,   z(t) = z_i + v_i (1 - exp(-d t))/d - g (d t - 1 + exp(-d t))/d^2,
/// where t counts from the middle of the flight. Gravity g and the drag rate d are common to all flights,
/// fitted or given. Two consecutive flights meet where their curves cross; there
///     e = (v_after - v_plate)/(v_plate - v_before).

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell::calibration {

/// Measured height of the bead at one time.
struct BounceSample {
  double time = 0, height = 0;
};

/// Height and velocity of the plate at one time. {0, 0} for a plate at rest, where only height differences
/// matter.
struct PlateAt {
  double height = 0, velocity = 0;
};
using PlateMotionAt = std::function<PlateAt(double time)>;

struct BounceOptions {
  std::optional<double> gravity;  ///< if given, fixed in the fit
  bool drag = true;               ///< whether the fit includes drag
  PlateMotionAt plate;            ///< empty: at rest
};

/// One impact, between two fitted flights.
struct BounceImpact {
  double time = 0, speed = 0;  ///< speed relative to the plate, before the impact
  double restitution = 0, error = 0;
};

struct BounceFit {
  FitReport fit;  ///< "gravity" and "drag" if fitted, then "z_1", "v_1" ... of each flight
  double gravity = 0, gravity_error = 0;
  double drag = 0, drag_error = 0;
  double rms = 0;  ///< of the residual heights
  std::size_t flights = 0, samples = 0, outliers = 0;
  std::vector<BounceImpact> impacts;
  double restitution = 0, restitution_error = 0;
  std::vector<std::string> notes;
};

/// Fits all flights together by least squares, after a fit with Cauchy's loss has identified the outliers.
/// Errors of e come from the joint covariance, because neighbouring impacts share a flight. \throws
/// InputError if fewer than two flights of at least 6 samples are found, or if the result is none of a
/// bouncing bead: gravity not above 0, e_n above 1 or below 0 by more than three errors, an error of e_n
/// above 0.3
BounceFit fit_bounces(std::vector<BounceSample> samples, const BounceOptions& options = {});

}  // namespace twincell::calibration
