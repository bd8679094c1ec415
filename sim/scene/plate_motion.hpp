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

/// Whether the stored Frame::plate_height `stored` is what a run of the scene stores at the displacement
/// `displacement` of its drive, both in sigma: equal to 1e-9, or 0 if the plate rests. NaN, unknown, agrees.
inline bool plate_agrees(const Scene& scene, double stored, double displacement) {
  constexpr double kSamePlate = 1e-9;
  return std::isnan(stored) || std::abs(stored - displacement) <= kSamePlate ||
         (!plate_follows_drive(scene) && stored == 0);
}

}  // namespace twincell::sim
