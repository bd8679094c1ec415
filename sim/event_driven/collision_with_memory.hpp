#pragma once
/// \file
/// One isolated collision with a tangential spring: the law of Fortini & Huang 2015 (eq. A3) with its Coulomb
/// limit, solved as a differential equation with events (docs/friction.md). It is the reference for every
/// kernel, and the event-driven solver (event_driven_solver.hpp) uses it between first touch and parting.

#include "sim/event_driven/collision.hpp"

namespace twincell::sim {

struct ContactLaws;
enum class SlipReading;  // laws/tangential/spring.hpp

/// The reading that the tangential law uses. Requires remembers(laws).
SlipReading reading_of(const ContactLaws& laws);

/// As integrate_collision() (binary_collision.hpp), for laws with history. The spring is 0 at the start, so
/// `motion` is the motion at first touch.
///
/// State: r, u, s, and, while the surfaces stick, xi. While they slide, the direction of the force replaces
/// xi, because its magnitude is mu |F_n|. Runge-Kutta-Fehlberg steps of order 8 go from event to event: the
/// Coulomb limit begins or ceases to bind, F_n vanishes, the surfaces part. Events are located to round-off.
/// \param steps per contact time; with 200 the error is below 1e-11
CollisionEnd integrate_collision_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                             double time, double last, SlipReading reading, int steps = 200);

/// As force_of() (binary_collision.hpp), for a spring of length xi.
CollisionForce force_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                 const Vec3& xi, SlipReading reading);

}  // namespace twincell::sim
