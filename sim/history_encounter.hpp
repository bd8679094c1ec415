#pragma once
/// \file
/// One isolated collision with friction that remembers: the tangential spring of Fortini & Huang 2015
/// (eq. A3) with its Coulomb limit, as a differential equation with events (docs/friction.md). The reference
/// for every kernel, and what flights (flight_kernel.hpp) do between first touch and parting.

#include "sim/encounter.hpp"

namespace twincell::sim {

/// What becomes of the spring where spring and dashpot together exceed the Coulomb limit mu |F_n|. The paper
/// says "truncate".
enum class SlipReading {
  rescale,      ///< cut so that spring and dashpot together are the limit (SpringSlider; LAMMPS)
  spring_only,  ///< the spring alone is held at the limit, the dashpot dropped meanwhile (SpringOnlySlider)
  clip,         ///< only the force is cut; the spring goes on to stretch
};

/// Whether encounters of these laws are of this kind: a spring with history, a normal force without memory,
/// no resistance to rolling.
bool remembers(const ContactLaws& laws);
/// How the laws' spring reads. Needs remembers(laws).
SlipReading reading_of(const ContactLaws& laws);

/// As meet() (encounter.hpp), for laws that remember. The spring is 0 at the start: `motion` is that of first
/// touch.
///
/// State: r, u, s, and xi while the surfaces stick; while they slide the direction of the force, since its
/// size is mu |F_n|. Runge-Kutta-Fehlberg steps of order 8 go from event to event: the Coulomb limit begins
/// to bind, or ceases to, F_n vanishes, the surfaces part. Events are found to round-off.
/// \param steps per contact time; 200 leave an error below 1e-11
EncounterEnd meet_with_history(const EncounterSetting& setting, const RelativeMotion& motion, double time,
                               double last, SlipReading reading, int steps = 200);

/// As force_of() (encounter.hpp), with a spring of length xi.
EncounterForce force_with_history(const EncounterSetting& setting, const RelativeMotion& motion,
                                  const Vec3& xi, SlipReading reading);

}  // namespace twincell::sim
