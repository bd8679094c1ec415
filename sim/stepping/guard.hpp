#pragma once
/// \file
/// Guards that stop an unhealthy run with an error that names the likely cause.

#include <cmath>

#include "sim/scene/plan.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

/// Bounds within which a run counts as healthy.
struct GuardLimits {
  double overlap = kOverlapBound;         ///< sigma
  double travel_per_step = kTravelBound;  ///< sigma; a bead faster than this could pass through another
  double ceiling = 0;             ///< height above the plate that no bead may reach, sigma; 0: no limit
  double stable_step = HUGE_VAL;  ///< t0; with longer steps a bed of beads in contact is unstable
};

/// Bounds of a plan, without a ceiling.
GuardLimits guard_limits(const Plan& plan);

/// Throws RunError for the deepest overlap, naming step, time, beads and the likely cause.
[[noreturn]] void explain_overlap(const System& system, const GuardLimits& limits);

/// Throws RunError for a position or speed that is not finite, for a bead that is too fast for the step, and
/// for a bead at the ceiling.
void check_motion(const System& system, const GuardLimits& limits);

}  // namespace twincell::sim
