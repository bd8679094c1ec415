#pragma once
/// \file
/// Side walls of a cell from the beads that touch them, for trajectories without the original frames.

#include <cstddef>

#include "trajectory/trajectory.hpp"

namespace twincell::calibration {

/// Walls x = x_left - tan(tilt_left) z and x = x_left + width + tan(tilt_right) z. Lengths are in sigma,
/// tilts in degrees outward, and z counts from the plate.
struct BeadWalls {
  double x_left = 0, x_left_error = 0, x_right_error = 0;
  double width = 0, width_error = 0;
  double tilt_left = 0, tilt_left_error = 0, tilt_right = 0, tilt_right_error = 0;
  std::size_t rows = 0;  ///< slices with beads at a wall; the smaller number of the two sides
};

/// Fits one straight line per wall. Beads are sorted into slices of height 0.5 sigma. In each slice with at
/// least 20 beads, the point of the wall is the mean position of the outermost hundredth (at least three) of
/// the beads' surfaces over all frames. Slices more than 0.05 sigma (and half of the rms deviation) inside of
/// the line are left out, as the rows of a crystal that do not touch the wall. The errors of the places
/// contain the distance of the median of the beads within 0.05 sigma: noise carries the outermost ones
/// outwards, and none need touch. If no bead touches a wall, the fitted wall is at the closest approach of
/// the beads, which is inside the true wall.
///
/// \throws InputError if fewer than three slices of a side have enough beads
BeadWalls walls_from_beads(const TrajectorySource& trajectory);

}  // namespace twincell::calibration
