#pragma once
/// \file
/// Side walls from the beads that lean on them, where only a trajectory is left.

#include <cstddef>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Walls x = x_left - tan(tilt_left) z and x = x_left + width + tan(tilt_right) z; lengths in sigma, degrees
/// outward, z from the plate.
struct BeadWalls {
  double x_left = 0, x_left_error = 0, x_right_error = 0;
  double width = 0, width_error = 0;
  double tilt_left = 0, tilt_left_error = 0, tilt_right = 0, tilt_right_error = 0;
  std::size_t rows = 0;  ///< heights at which beads leaned on a wall, the fewer of both sides
};

/// In slices of half a bead's height, the outermost places of the beads' surfaces over all frames: the mean
/// of the outermost hundredth (at least three). A wall that is never touched is put where beads came nearest,
/// which is inside it. \throws InputError if fewer than three slices hold beads enough
BeadWalls walls_from_beads(const TrajectorySource& trajectory);

}  // namespace twincell
