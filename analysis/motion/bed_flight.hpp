#pragma once
/// \file
/// Flights of the bed: when its centre of mass is off the plate.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// The bed is in flight if the plate supports less than this share of its weight.
inline constexpr double kFlyingSupport = 0.25;

/// Flights of the bed. Results:
///
/// - flight_time: scalar, mean duration of a flight, t0
/// - flight_share: scalar, share of the time that is spent in flight, 0 for a bed that rests on its plate
///
/// The support of the bed follows from its centre of mass alone: support/weight = 1 + (d2z_cm/dt2)/g_z,
/// computed by the second difference of instants a twentieth of a cycle apart. Where it is below
/// kFlyingSupport, the bed is in flight, and a parabola of acceleration -g_z is fitted to z_cm. With h(t) the
/// parabola's height above the moving plate:
///
/// - take-off: the instant at which h begins to rise with positive acceleration, as for a bed that leaves
///   with the plate's velocity (for a bed that is thrown off: between the frames before and after)
/// - landing: the first later t with h(t) = h(take-off)
///
/// These definitions need no rest height. A bead that is not detected in every frame contributes only between
/// consecutive frames in which it is detected, so that z_cm does not jump with it. The method is exact for a
/// bed that does not rebound (the completely inelastic ball of Mehta & Luck 1990). Flights shorter than three
/// frames and flights cut off by the ends of the film are not detected. g_z is the component of the run's
/// gravity along -z: Drive::gravity times Drive::downward_share, g cos(theta) of a cell tilted by theta.
///
/// Both results are absent without a drive along z, if the plate rests while the drive moves other walls, or
/// with fewer than 8 frames per cycle. flight_time is also absent if the bed does not leave the plate.
extern const ObservableEntry bed_flight_observable;

}  // namespace twincell::analysis
