#pragma once
/// \file
/// Whether the plate of a scene follows its drive.

#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Whether the drive moves the plate. It does not if it is along z and the bottom wall rests
/// (cell.bottom_motion = "rest"); Frame::plate_height is then 0. A drive along x or y moves the cell
/// sideways, and Frame::plate_height is the displacement of its other walls even if the bottom rests.
inline bool plate_follows_drive(const Scene& scene) {
  return scene.drive.axis != Axis::z || scene.bottom != Edge::wall || scene.bottom_moves;
}

}  // namespace twincell::sim
