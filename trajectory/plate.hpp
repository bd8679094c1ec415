#pragma once
/// \file
/// Where the plate is in a frame. Frame::plate_height is a displacement along Drive::axis, which is a height
/// only for a drive along z. Code that needs the height of the plate calls these functions.

#include <optional>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Displacement of the drive in `frame` along Drive::axis, sigma: the stored Frame::plate_height, else that
/// of the drive at the frame's phase. Absent if neither is known.
std::optional<double> plate_displacement(const TrajectoryInfo& info, const Frame& frame);

/// Height z of the plate in `frame`, sigma, above its mean: plate_displacement of a drive along z, 0 of a
/// drive along x or y. Absent if neither a drive nor a stored height is known.
std::optional<double> plate_height(const TrajectoryInfo& info, const Frame& frame);

/// Displacement of the cell in `frame` by a drive along x or y, sigma; zero for a drive along z, and where it
/// is not known. Drive::horizontal, a motion beside that along z, is excluded.
Vec3 sideways_displacement(const TrajectoryInfo& info, const Frame& frame);

/// Whether the drive, along z, moves other walls while the plate rests (cell.bottom_motion = "rest"), as far
/// as `frame` shows it: its stored height is 0 and the displacement of the drive is not.
bool plate_rests(const TrajectoryInfo& info, const Frame& frame);

}  // namespace twincell
