#pragma once
/// \file
/// e_n of bead and plate from a filmed bead that bounces on it, at rest or vibrating.
///
/// Between two impacts the bead flies:
///     dv/dt = -g - d v,   z(t) = z_i + v_i (1 - exp(-d t))/d - g (d t - 1 + exp(-d t))/d^2,   t from the
///     flight's middle,
/// with g and the drag rate d shared by all flights, free or given. Two flights meet where they cross; there
///     e = (v_after - v_plate)/(v_plate - v_before).

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell {

struct BounceSample {
  double time = 0, height = 0;
};

/// The plate's height and velocity at a time; a plate at rest: {0, 0}, for only differences of heights are
/// used then.
struct PlateAt {
  double height = 0, velocity = 0;
};
using PlateMotionAt = std::function<PlateAt(double time)>;

struct BounceOptions {
  std::optional<double> gravity;  ///< given: held
  bool drag = true;               ///< whether a drag is fitted
  PlateMotionAt plate;            ///< empty: at rest
};

/// One impact, between two flights that were fitted.
struct BounceImpact {
  double time = 0, speed = 0;  ///< relative to the plate, before
  double restitution = 0, error = 0;
};

struct BounceFit {
  FitReport fit;  ///< "gravity" and "drag" where they were fitted, then "z_1", "v_1" ... of each flight
  double gravity = 0, gravity_error = 0;
  double drag = 0, drag_error = 0;
  double rms = 0;  ///< of the heights about the flights
  std::size_t flights = 0, samples = 0, outliers = 0;
  std::vector<BounceImpact> impacts;
  double restitution = 0, restitution_error = 0;
  std::vector<std::string> notes;
};

/// Least squares to all flights together, after Cauchy's loss has told outliers. Errors of e from the joint
/// covariance, in which neighbouring impacts share a flight.
/// \throws InputError if fewer than two flights of at least 6 samples are found
BounceFit fit_bounces(std::vector<BounceSample> samples, const BounceOptions& options = {});

}  // namespace twincell
