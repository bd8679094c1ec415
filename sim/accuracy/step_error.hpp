#pragma once
/// \file
/// What a scene's own law, integrator and step make of one collision.

#include <optional>

#include "sim/accuracy/impacts.hpp"
#include "sim/scene/plan.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// A head-on collision of two beads and what is wrong with it.
struct StepError {
  double speed = 0;        ///< at which they meet, sqrt(g sigma)
  double restitution = 0;  ///< e, of the same law in steps so short that they do not matter
  PhaseSpread error;       ///< of e, over the share of a step at which the contact begins
  /// Of oblique impacts at the same speed, sliding and sticking: 15, 30, 45, 60 and 75 degrees from the
  /// normal. None without friction, or where their exact outcome is not known (resistance to rolling, laws
  /// whose normal force remembers).
  std::optional<ImpactErrors> friction = {};
};

/// Lets two usual beads of the scene meet without gravity at each of `phases` entry phases, in the plan's
/// step. They meet at twice the plate's largest speed, but at least at that of a fall by sigma, and slowly
/// enough that they overlap by half of what the guard admits. The reference is split at entry and exit and
/// takes eight times as many steps, at least 2000 a contact: its own error is some 1e-8 at e = 0.9.
/// Oblique impacts are held against their exact outcome (exact_outcomes).
/// \return nothing if they do not part: damped critically or more
std::optional<StepError> step_error(const Scene& scene, const Plan& plan, int phases = 32);

/// Says in the plan's list of effects what step_error() finds.
void state_step_error(const Scene& scene, Plan& plan);

}  // namespace twincell::sim
