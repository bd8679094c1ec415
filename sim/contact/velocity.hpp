#pragma once
/// \file
/// The choice of velocity at the end of a step.

namespace twincell::sim {

/// Velocity that the laws use at the end of a step. Leapfrog gives positions there, but velocities only in
/// the middle of steps.
enum class Velocity {
  half_step,  ///< that of the middle of the step: dashpots lag by dt/2, first order in dt
  full_step,  ///< that of the end, extrapolated from the last two middles: second order during a contact
};

}  // namespace twincell::sim
