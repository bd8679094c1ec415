#pragma once
/// \file
/// When the bed is off the plate.

#include <memory>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// The plate carries less than this share of the bed's weight: the bed flies.
inline constexpr double kFlyingSupport = 0.25;

/// Results flight_time (mean duration of a flight, t0) and flight_share (share of the time that is spent in
/// flight, 0 for a bed that rests on its plate).
///
/// What carries the bed follows from its centre of mass alone: support/weight = 1 + d2z_cm/dt2, here by the
/// second difference of moments a twentieth of a cycle apart. Where it is below kFlyingSupport the bed flies,
/// and a parabola of acceleration -1 is fitted to z_cm. With h(t) the parabola's height above the moving
/// plate
///     take-off: where h begins to rise and to rise faster and faster, as of a bed that left with the plate's
///               velocity (thrown off: between the moments before and after)
///     landing:  the first later t with h(t) = h(take-off)
/// so that no height at rest is needed. Beads that are not seen in every frame count where they are seen
/// twice in a row, so that z_cm does not jump with them. Exact for a bed that does not rebound (the
/// completely inelastic ball of Mehta & Luck 1990). Not seen: flights shorter than three moments, and those
/// that the film cuts off. Gravity is the unit of acceleration, along -z.
///
/// Absent without a drive along z or with fewer than 8 frames per cycle; flight_time also where nothing
/// flies.
std::unique_ptr<Observable> make_bed_flight(const AnalysisContext& context);

}  // namespace twincell
