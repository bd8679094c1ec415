#pragma once
/// \file
/// One isolated collision with friction that remembers: the tangential spring of Fortini & Huang 2015
/// (eq. A3) with its Coulomb limit, as a differential equation with events (docs/friction.md). The reference
/// for every kernel, and what flights (event_driven_solver.hpp) do between first touch and parting.

#include "sim/event_driven/collision.hpp"

namespace twincell::sim {

/// What becomes of the spring where spring and dashpot together exceed the Coulomb limit mu |F_n|. The paper
/// says "truncate".
enum class SlipReading {
  rescale,      ///< cut so that spring and dashpot together are the limit (SpringSlider; LAMMPS)
  spring_only,  ///< the spring alone is held at the limit, the dashpot dropped meanwhile (SpringOnlySlider)
  clip,         ///< only the force is cut; the spring goes on to stretch (ForceClippedSlider)
};

/// How the laws' spring reads. Needs remembers(laws).
SlipReading reading_of(const ContactLaws& laws);

/// As integrate_collision() (binary_collision.hpp), for laws that remember. The spring is 0 at the start:
/// `motion` is that of first touch.
///
/// State: r, u, s, and xi while the surfaces stick; while they slide the direction of the force, since its
/// size is mu |F_n|. Runge-Kutta-Fehlberg steps of order 8 go from event to event: the Coulomb limit begins
/// to bind, or ceases to, F_n vanishes, the surfaces part. Events are found to round-off.
/// \param steps per contact time; 200 leave an error below 1e-11
CollisionEnd integrate_collision_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                             double time, double last, SlipReading reading, int steps = 200);

/// As force_of() (binary_collision.hpp), with a spring of length xi.
CollisionForce force_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                 const Vec3& xi, SlipReading reading);

}  // namespace twincell::sim
