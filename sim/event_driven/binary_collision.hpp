#pragma once
/// \file
/// One isolated collision, of two beads or of a bead and a wall, integrated to round-off: what event-driven
/// flight (event_driven_solver.hpp) does between first touch and parting, with the same laws as every kernel.

#include "sim/event_driven/collision.hpp"

namespace twincell::sim {

/// Integrates from `motion` at `time` (in contact, or at first touch) until the surfaces part or `last`.
///
/// Steps of order 15 (collocation.hpp) of at most half a contact time, as long as `tolerance` allows; the
/// polynomial that each one is tells where the Coulomb limit begins or ceases to bind, where F_n changes its
/// sign, and where the surfaces part, and there it ends.
///
/// Laws that remember begin with a spring of length 0: `motion` is that of first touch.
/// \param tolerance of lengths and velocities relative to those of the collision; 1e-13 .. 1e-3
CollisionEnd integrate_collision(const CollisionSetting& setting, const RelativeMotion& motion, double time,
                                 double last, double tolerance);

/// Contact force on i now, its turning moment n x F_t, and n.
/// \param xi the tangential spring, of laws that remember
CollisionForce force_of(const CollisionSetting& setting, const RelativeMotion& motion,
                        const Vec3& xi = Vec3::Zero());

}  // namespace twincell::sim
