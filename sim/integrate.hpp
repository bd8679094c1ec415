#pragma once
/// \file
/// Velocity Verlet with half-step velocities in the dashpots: kick, drift, forces from x(t+dt) and v(t+dt/2),
/// kick.

#include <cmath>

#include "sim/state.hpp"

namespace twincell::sim {

/// Velocity and spin half a step on.
template <bool kSpin>
inline void half_kick(System& s) {
  const double h = s.dt / 2;
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    Bead& b = s.beads[i];
    const Force& f = s.forces[i];
    b.vx += h * f.x / b.mass;
    b.vz += h * f.z / b.mass;
    if constexpr (kSpin) b.spin += h * f.torque / b.inertia;
  }
}

/// One step. `forces(system)` fills system.forces and returns the largest overlap, which is passed on.
template <bool kSpin, class Forces>
inline double verlet_step(System& s, Forces& forces) {
  half_kick<kSpin>(s);
  for (Bead& b : s.beads) {
    b.x += s.dt * b.vx;
    b.z += s.dt * b.vz;
  }
  ++s.step;
  const double largest = forces(s);
  half_kick<kSpin>(s);
  return largest;
}

}  // namespace twincell::sim
