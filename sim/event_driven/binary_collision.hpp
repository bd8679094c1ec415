#pragma once
/// \file
/// Integration of one isolated collision of two beads, or of a bead and a wall, from first touch to parting.
/// The event-driven solver (event_driven_solver.hpp) uses it for every binary collision, with the same
/// contact laws as all kernels.

#include "sim/event_driven/collision.hpp"

namespace twincell::sim {

/// Integrates from `motion` at `time` (in contact, or at first touch) until the surfaces part or until
/// `last`.
///
/// The steps have order 15 (collocation.hpp) and are at most about half a contact time long, or shorter if
/// `tolerance` requires it. A step ends at the first event that its polynomial shows: the Coulomb limit
/// begins or ceases to bind, F_n changes its sign, or the surfaces part.
///
/// For laws with history the tangential spring has length 0 at the start, so `motion` is the motion at first
/// touch.
/// \param tolerance of lengths and velocities relative to those of the collision; 1e-13 .. 1e-3
CollisionEnd integrate_collision(const CollisionSetting& setting, const RelativeMotion& motion, double time,
                                 double last, double tolerance);

/// Present contact force on i, n x F_t (which gives the torque), and n.
/// \param xi the tangential spring, for laws with history
CollisionForce force_of(const CollisionSetting& setting, const RelativeMotion& motion,
                        const Vec3& xi = Vec3::Zero());

}  // namespace twincell::sim
