#pragma once
/// \file
/// What a kernel moves: beads, plate, clock. 2D, reduced units, plate mean at z = 0, cell between x = 0 and x
/// = width.

#include <cstdint>
#include <vector>

#include "analysis/trajectory/drive.hpp"

namespace twincell::sim {

/// One bead in one 64-byte record, so that a contact touches two cache lines. spin is counter-clockwise in
/// the (x right, z up) drawing.
struct alignas(64) Bead {
  double x = 0, z = 0;
  double vx = 0, vz = 0;
  double spin = 0;
  double radius = 0.5;
  double mass = 1;
  double inertia = 0.125;
};

/// Force and torque on a bead.
struct Force {
  double x = 0, z = 0, torque = 0;
};

/// Beads, cell, plate and clock.
struct System {
  std::vector<Bead> beads;
  std::vector<Force> forces;  ///< at the present positions; same length as beads
  double width = 20;
  bool side_walls_move = true;  ///< side walls ride with the plate
  double gravity = 1;           ///< along -z
  double gravity_x = 0;         ///< along +x: a tilted cell

  Drive drive;
  std::int64_t steps_per_period = 1;
  std::int64_t step = 0;  ///< whole steps since phase 0: time is step * dt, never a running sum
  double dt = 0;

  /// Fraction of the period at the present step, the same bits in every period.
  [[nodiscard]] double phase() const {
    return static_cast<double>(step % steps_per_period) / static_cast<double>(steps_per_period);
  }
  [[nodiscard]] double time() const { return static_cast<double>(step) * dt; }
  [[nodiscard]] double plate_height() const { return drive.displacement(phase()); }
  [[nodiscard]] double plate_velocity() const { return drive.velocity(phase()); }
};

}  // namespace twincell::sim
