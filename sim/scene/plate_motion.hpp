#pragma once
/// \file
/// Whether the plate of a scene follows its drive, and whether the plate of a file is that of the scene.

#include <cmath>

#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Whether the drive moves the plate. It does not if it is along z and the bottom wall rests
/// (cell.bottom_motion = "rest"); Frame::plate_height is then 0. A drive along x or y moves the cell
/// sideways, and Frame::plate_height is the displacement of its other walls even if the bottom rests.
inline bool plate_follows_drive(const Scene& scene) {
  return scene.drive.axis != Axis::z || scene.bottom != Edge::wall || scene.bottom_moves;
}

/// Displacement of the walls that move, at a phase of the first cycle, sigma.
inline Vec3 cell_displacement(const Scene& scene, double phase) {
  return scene.envelope.at(phase) * scene.drive.displacement_in_space(phase);
}

/// Largest difference of two displacements that are the same one, sigma.
inline constexpr double kSameDisplacement = 1e-9;

/// The Frame::plate_height that a run of the scene stores at the displacement `displacement` of its drive,
/// sigma.
inline double stored_plate_height(const Scene& scene, double displacement) {
  return plate_follows_drive(scene) ? displacement : 0;
}

/// Whether the Frame::plate_height of a file is the one that a run of the scene stores. NaN, unknown, agrees.
inline bool plate_agrees(const Scene& scene, double stored, double displacement) {
  return std::isnan(stored) ||
         std::abs(stored - stored_plate_height(scene, displacement)) <= kSameDisplacement;
}

}  // namespace twincell::sim
