#pragma once
/// \file
/// Error of a single collision with the law, integrator and time step of a scene.

#include <optional>
#include <vector>

#include "sim/accuracy/impacts.hpp"
#include "sim/scene/plan.hpp"
#include "sim/scene/scene.hpp"
#include "sim/start/start_speeds.hpp"

namespace twincell::sim {

/// A head-on collision of two beads and its errors.
struct StepError {
  double speed = 0;        ///< of approach, sqrt(g sigma)
  double restitution = 0;  ///< e of the same law, with steps so short that their error is negligible
  EntryPhaseSpread error;  ///< of e, over the entry phases
  /// Errors of oblique impacts at the same speed, sliding and sticking: 15, 30, 45, 60 and 75 degrees from
  /// the normal. Absent without friction, or if their exact outcome is not available (rolling resistance,
  /// laws whose normal force has history), or if the beads do not part.
  std::optional<ImpactErrors> friction = {};
};

/// Simulates a collision of two beads of median radius, without gravity, at each of `phases` entry phases,
/// with the time step of the plan. They meet at `speed`; without one, at twice the largest speed of the
/// plate, or at the speed of a fall by sigma if that is larger, but never so fast that they overlap, or
/// travel in a step, by more than half of the guard's bounds. The reference uses "split" and eight times as
/// many steps, at least 2000 per contact; its own error is about 1e-8 at e = 0.9. Oblique impacts are
/// compared with their exact outcome (exact_outcomes). \return nothing if the beads do not part, that is,
/// with critical damping or more, or if cohesion holds them
std::optional<StepError> step_error(const Scene& scene, const Plan& plan, int phases = 32,
                                    std::optional<double> speed = {});

/// The speeds for which the error of a collision is stated, sqrt(g sigma): that of step_error(), or the
/// typical and the largest speed of the start where they are larger. In ascending order.
std::vector<double> stated_speeds(const Scene& scene, const Plan& plan,
                                  const std::optional<StartSpeeds>& start);

/// Adds the results of step_error() at stated_speeds() to the list of effects of the plan.
/// \param start speeds_of_start() of the beads
void state_step_error(const Scene& scene, Plan& plan, const std::optional<StartSpeeds>& start = {});

}  // namespace twincell::sim
