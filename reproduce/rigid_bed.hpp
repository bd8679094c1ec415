#pragma once
/// \file
/// A bed whose motion is known in closed form: a completely inelastic rigid crystal on a vibrating plate
/// (omega = 1, g = 1, A = Gamma), optionally with a shear that grows every cycle. Its s_b and s_c therefore
/// have closed forms.

#include <cmath>
#include <numbers>
#include <string>

#include "trajectory/trajectory.hpp"

namespace twincell::reproduce {

/// Height of the bed above the plate at phase angle phi in [0, 2 pi). The bed takes off at sin(phi) = 1/Gamma
/// and sticks to the plate when it lands. Valid for Gamma < 3.29, where the flight is shorter than a period.
inline double rigid_bed_height(double gamma, double phi) {
  if (gamma <= 1) return 0;
  const double start = std::asin(1 / gamma);
  const auto gap = [&](double t) {
    return 1 + gamma * std::cos(start) * t - t * t / 2 - gamma * std::sin(start + t);
  };
  double low = 1e-3, high = 2 * std::numbers::pi;  // gap > 0 just after take-off, < 0 before the next
  while (gap(low) <= 0) low *= 0.5;
  for (double t = low; t < high; t += 0.01)
    if (gap(t) < 0) {
      high = t;
      break;
    }
  low = high - 0.01;
  for (int i = 0; i < 60; ++i) (gap((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
  double since = phi - start;
  if (since < 0) since += 2 * std::numbers::pi;
  return since < low ? gap(since) : 0;
}

/// Parameters of the rigid bed.
struct RigidBed {
  double gamma = 1.5;
  int columns = 20;  ///< beads in an even row; odd rows have one less
  int rows = 10;
  int phases = 20;
  int cycles = 10;
  double shear_per_cycle = 0;  ///< z_i += shear (x_i - middle) j
  bool velocities = true;
  Origin source = Origin::simulation;
};

/// Appends the bed's frames to `sink`.
inline void film_rigid_bed(const RigidBed& bed, const TrajectoryInfo& info, TrajectorySink& sink) {
  const double row_height = std::sqrt(3.0) / 2;
  std::vector<Vec3> rest;
  for (int row = 0; row < bed.rows; ++row)
    for (int c = 0; c < bed.columns - row % 2; ++c)
      rest.emplace_back(0.5 + c + 0.5 * (row % 2), 0.0, 0.5 + row * row_height);
  for (int j = 0; j < bed.cycles; ++j)
    for (int k = 0; k < bed.phases; ++k) {
      Frame frame;
      const double fraction = static_cast<double>(k) / bed.phases;
      const double phi = 2 * std::numbers::pi * fraction;
      frame.step = j * bed.phases + k;
      frame.time = 2 * std::numbers::pi * (j + fraction);
      frame.phase = k;
      frame.cycle = j;
      frame.plate_height = info.drive->displacement(fraction);
      constexpr double kStep = 1e-6;
      const double rise =
          rigid_bed_height(bed.gamma, phi) > 0
              ? (rigid_bed_height(bed.gamma, phi + kStep) - rigid_bed_height(bed.gamma, phi - kStep)) /
                    (2 * kStep)
              : 0;
      for (const Vec3& r : rest) {
        const double lift =
            rigid_bed_height(bed.gamma, phi) + bed.shear_per_cycle * (r.x() - bed.columns / 2.0) * j;
        frame.position.emplace_back(r + Vec3(0, 0, frame.plate_height + lift));
        if (bed.velocities) frame.velocity.emplace_back(0, 0, info.drive->velocity(fraction) + rise);
      }
      sink.append(frame);
    }
}

/// Metadata of the bed's trajectory.
inline TrajectoryInfo rigid_bed_info(const RigidBed& bed) {
  TrajectoryInfo info;
  info.n_beads = 0;
  for (int row = 0; row < bed.rows; ++row) info.n_beads += static_cast<std::size_t>(bed.columns - row % 2);
  info.columns.velocity = bed.velocities;
  info.columns.phase = true;
  info.columns.plate_height = true;
  info.box.lower = Vec3(0, -0.5, 0);
  info.box.upper = Vec3(bed.columns, 0.5, bed.rows + 15);
  info.drive = Drive{Axis::z, bed.gamma, 1.0};
  info.phases_per_cycle = bed.phases;
  info.source = bed.source;
  return info;
}

/// Trajectory of the bed.
inline MemoryTrajectory rigid_bed(const RigidBed& bed) {
  MemoryTrajectory trajectory(rigid_bed_info(bed));
  film_rigid_bed(bed, trajectory.info(), trajectory);
  return trajectory;
}

}  // namespace twincell::reproduce
