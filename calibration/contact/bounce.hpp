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
/// Over a plate at rest and without drag this is the ratio of the durations of consecutive flights, e =
/// t_{i+1}/t_i, because a flight that begins with the velocity v lasts 2 v/g.
///
/// L and T below are the units of the heights and times of the samples; e has no unit.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell::calibration {

/// Measured height of the bead at one time.
struct BounceSample {
  double time = 0;    ///< T
  double height = 0;  ///< L, upwards
};

/// Height and velocity of the plate at one time. {0, 0} for a plate at rest, where only height differences
/// matter.
struct PlateState {
  double height = 0;    ///< L, upwards
  double velocity = 0;  ///< L/T
};
/// State of the plate at a time, T.
using PlateMotionAt = std::function<PlateState(double time)>;

/// Options of fit_bounces().
struct BounceOptions {
  std::optional<double> gravity;  ///< g, L/T^2; if given, fixed in the fit
  bool drag = true;               ///< whether the fit includes drag
  PlateMotionAt plate;            ///< empty: at rest
};

/// One impact, between two fitted flights.
struct BounceImpact {
  double time = 0;         ///< T
  double speed = 0;        ///< relative to the plate, before the impact, L/T
  double restitution = 0;  ///< e of this impact
  double error = 0;        ///< standard error of e
};

/// Result of fit_bounces(). Errors are standard errors.
struct BounceFit {
  FitReport fit;  ///< "gravity" and "drag" if fitted, then "z_1" (L), "v_1" (L/T) ... of each flight
  double gravity = 0, gravity_error = 0;          ///< g, L/T^2; error 0 if given
  double drag = 0, drag_error = 0;                ///< d, 1/T; error 0 if not fitted
  double rms = 0;                                 ///< residual height, L
  std::size_t flights = 0;                        ///< number of fitted flights
  std::size_t samples = 0;                        ///< number of heights that are fitted
  std::size_t outliers = 0;                       ///< number of heights left out as outliers
  std::vector<BounceImpact> impacts;              ///< flights - 1
  double restitution = 0, restitution_error = 0;  ///< e_n, mean over the impacts
  std::vector<std::string> notes;                 ///< warnings, as sentences without a full stop
};

/// Fits all flights together by least squares, after a fit with Cauchy's loss has identified the outliers.
/// Errors of e come from the joint covariance, because neighbouring impacts share a flight.
/// \throws InputError if fewer than two flights of at least 6 samples are found, if the heights do not follow
/// free flights, or if the result cannot describe a bouncing bead: gravity not above 0, an impact without
/// approach, e_n above 1 or below 0 by more than three errors, an error of e_n above 0.3
BounceFit fit_bounces(std::vector<BounceSample> samples, const BounceOptions& options = {});

}  // namespace twincell::calibration
