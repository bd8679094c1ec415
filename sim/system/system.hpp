#pragma once
/// \file
/// The state that a solver advances: beads, walls, plate and clock. Reduced units; the mean height of the
/// plate is z = 0. A 2D system is in the plane y = 0.

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "trajectory/drive.hpp"

namespace twincell::sim {

/// One bead. The angular velocity is (spin_x, -spin, spin_z): `spin` is counter-clockwise in a drawing with x
/// to the right and z up, and is the only component in 2D.
struct Bead {
  double x = 0, z = 0;
  double vx = 0, vz = 0;
  double spin = 0;
  double radius = 0.5;
  double mass = 1;
  double inertia = 0.125;
  double y = 0, vy = 0;  ///< 3D only
  double spin_x = 0, spin_z = 0;
};

/// Contact force on a bead, and its torque divided by the bead's radius. In 2D q = sum F_t, so that inertia
/// dspin/dt = -radius q. In 3D (q_x, q_y, q_z) = sum n x F_t and inertia d(omega)/dt = -radius q.
struct Force {
  double x = 0, z = 0, q = 0;
  double y = 0, q_x = 0, q_z = 0;
};

/// A flat wall: the half space n . r < offset is solid. n points into the cell.
struct Wall {
  Vec3 n = Vec3::UnitZ();
  double offset = 0;  ///< n . w for a point w of the wall when the plate is at its mean position
  bool moves = true;  ///< moves with the plate
  std::string name;   ///< "bottom", "left", "right", "front", "back", "lid"
};

/// Factor f(t) on the amplitude of the drive, linear between points (cycle, f) and constant outside: a ramp,
/// or a schedule that fluidises a bed and then calms it.
struct Envelope {
  std::vector<std::pair<double, double>> points;  ///< cycles increase; empty: f = 1
  /// f after a number of cycles since phase 0.
  [[nodiscard]] double at(double cycles) const;
  [[nodiscard]] double slope(double cycles) const;  ///< per cycle
  /// Number of cycles after which f is constant.
  [[nodiscard]] double duration() const { return points.empty() ? 0 : points.back().first; }
};

/// Beads, cell, plate and clock.
struct System {
  std::vector<Bead> beads;
  std::vector<Force> forces;  ///< at the present positions; as long as beads, valid if forces_known
  bool forces_known = false;  ///< if false, the solver computes them
  /// Radius times angular velocity, as kernels store it; empty, or as long as beads. The division by the
  /// radius that gives the spin may lose the last bit, so this value is used if it agrees with the spin.
  std::vector<Vec3> rim_speeds;
  int dimension = 2;
  std::array<double, 3> period = {0, 0, 0};  ///< x, y, z; 0: not periodic
  Vec3 gravity = -Vec3::UnitZ();
  std::vector<Wall> walls;
  double plate_drag = 0;  ///< 2D substitute for front and back plates: force -plate_drag m (v - v_cell), 1/t0

  Drive drive;
  Envelope envelope;
  std::int64_t steps_per_period = 1;
  std::int64_t step = 0;  ///< whole steps since phase 0: time is step * dt, never a running sum
  double dt = 0;

  /// Fraction of the period at the present step. If the frequency is constant, with the same bits in every
  /// period.
  [[nodiscard]] double phase() const { return phase_at(step); }
  [[nodiscard]] double cycles() const { return cycles_at(step); }
  [[nodiscard]] double time() const { return static_cast<double>(step) * dt; }
  /// Displacement of the plate along drive.axis, sigma.
  [[nodiscard]] double plate_height() const { return plate_height_at(step); }
  /// Velocity of the plate along drive.axis, sqrt(g sigma).
  [[nodiscard]] double plate_velocity() const {
    return in_envelope(drive.velocity(phase(), cycle_of(step)), drive.displacement(phase(), cycle_of(step)));
  }
  /// Displacement (sigma) and velocity (sqrt(g sigma)) of the plate in space.
  [[nodiscard]] Vec3 plate_displacement() const { return plate_displacement_at(step); }
  [[nodiscard]] Vec3 plate_velocity_in_space() const {
    Vec3 v = plate_velocity() * Vec3::Unit(static_cast<int>(drive.axis));
    if (drive.horizontal)
      v.x() += in_envelope(drive.horizontal_velocity(phase()), drive.horizontal_displacement(phase()));
    return v;
  }
  /// Displacement of the plate at the previous step, sigma, with the same bits as then.
  [[nodiscard]] Vec3 plate_displacement_before() const { return plate_displacement_at(step - 1); }
  /// The step that is nearest to `cycles` cycles after phase 0.
  [[nodiscard]] std::int64_t step_at(double cycles) const {
    return std::llround(changes_frequency() ? drive.time_at(cycles) / dt
                                            : cycles * static_cast<double>(steps_per_period));
  }
  /// Whether the frequency of the drive changes, so that a cycle has no fixed number of steps.
  [[nodiscard]] bool changes_frequency() const { return drive.ramp && drive.ramp->changes_frequency(); }

 private:
  [[nodiscard]] double phase_at(std::int64_t k) const {
    if (changes_frequency()) return cycles_at(k) - std::floor(cycles_at(k));
    const std::int64_t n = steps_per_period;
    return static_cast<double>((k + n) % n) / static_cast<double>(n);  // k >= -1
  }
  [[nodiscard]] std::int64_t cycle_of(std::int64_t k) const {
    if (changes_frequency()) return static_cast<std::int64_t>(std::floor(cycles_at(k)));
    return (k + steps_per_period) / steps_per_period - 1;
  }
  [[nodiscard]] double cycles_at(std::int64_t k) const {
    if (changes_frequency()) return drive.cycles_at(static_cast<double>(k) * dt);
    return static_cast<double>(cycle_of(k)) + phase_at(k);
  }
  /// Velocity of a motion whose stroke the envelope multiplies.
  /// \param v, z of the motion without it
  [[nodiscard]] double in_envelope(double v, double z) const {
    if (envelope.points.empty()) return v;
    return envelope.at(cycles()) * v + envelope.slope(cycles()) / drive.period() * z;
  }
  [[nodiscard]] Vec3 plate_displacement_at(std::int64_t k) const {
    Vec3 r = plate_height_at(k) * Vec3::Unit(static_cast<int>(drive.axis));
    if (drive.horizontal) {
      const double x = drive.horizontal_displacement(phase_at(k));
      r.x() += envelope.points.empty() ? x : envelope.at(cycles_at(k)) * x;
    }
    return r;
  }
  [[nodiscard]] double plate_height_at(std::int64_t k) const {
    const double s = drive.displacement(phase_at(k), cycle_of(k));
    return envelope.points.empty() ? s : envelope.at(cycles_at(k)) * s;
  }
};

/// n . w of a wall at present, sigma.
inline double offset_now(const System& s, const Wall& wall) {
  return wall.moves ? wall.offset + wall.n.dot(s.plate_displacement()) : wall.offset;
}

}  // namespace twincell::sim
