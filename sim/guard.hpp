#pragma once
/// \file
/// What stops a run that goes wrong, and says why.

#include "sim/state.hpp"

namespace twincell::sim {

/// Bounds of a healthy run. The papers' runs stay below 0.03 sigma of overlap.
struct GuardLimits {
  double overlap = 0.1;           ///< sigma
  double travel_per_step = 0.05;  ///< sigma; a bead faster than this could pass through another
  double ceiling = 0;             ///< height of the lid above the plate, sigma; 0: open. The lid never acts.
};

/// Throws RunError for the deepest overlap, naming step, time, beads and the likely cause.
/// \param periodic_width 0 for side walls
[[noreturn]] void explain_overlap(const System& system, const GuardLimits& limits, double periodic_width);

/// Throws RunError for a position or speed that is not finite, a bead too fast for the step, a bead at the
/// lid.
void check_motion(const System& system, const GuardLimits& limits);

}  // namespace twincell::sim
