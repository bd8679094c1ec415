#pragma once
/// \file
/// What stops a run that goes wrong, and says why.

#include <cmath>

#include "sim/scene/plan.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

/// Bounds of a healthy run.
struct GuardLimits {
  double overlap = kOverlapBound;         ///< sigma
  double travel_per_step = kTravelBound;  ///< sigma; a bead faster than this could pass through another
  double ceiling = 0;                     ///< height above the plate that no bead may reach, sigma; 0: open
  double stable_step = HUGE_VAL;          ///< t0; longer steps shake a bed apart by themselves
};

/// Those of a plan, without a ceiling.
GuardLimits guard_limits(const Plan& plan);

/// Throws RunError for the deepest overlap, naming step, time, beads and the likely cause.
[[noreturn]] void explain_overlap(const System& system, const GuardLimits& limits);

/// Throws RunError for a position or speed that is not finite, a bead too fast for the step, a bead at the
/// ceiling.
void check_motion(const System& system, const GuardLimits& limits);

}  // namespace twincell::sim
