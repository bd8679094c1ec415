#pragma once
/// \file
/// What the program reads back from the report that `track` stores in a trajectory
/// (TrajectoryInfo::tracking_json). Members that an earlier version did not store are absent.

#include <optional>
#include <string>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// The camera's frames and the map by which their pixels became lengths.
struct TrackedCamera {
  double pixels_per_sigma = 0;
  double origin_x_px = 0, origin_y_px = 0;  ///< pixel of x = 0 and z = 0
  int width_px = 0, height_px = 0;          ///< of a frame
  std::optional<double> scale_error_px;     ///< standard error of pixels_per_sigma
  double rotation_deg = 0, distortion = 0;
};

/// The camera; absent in files of early versions and in files that `track` did not make.
///
/// \param name of the trajectory in messages
/// \throws InputError if the record is damaged
std::optional<TrackedCamera> tracked_camera(const TrajectoryInfo& info, const std::string& name);

/// Whether the beads were tracked as brighter than their background; false if it is not recorded.
bool tracked_as_bright(const TrajectoryInfo& info);

/// Phase of the first frame that was stated or found, a number of TrajectoryInfo::phases_per_cycle.
std::optional<int> tracked_first_phase(const TrajectoryInfo& info);

/// Relative standard error of the amplitude of the drive as the film shows it; absent if it was not measured.
std::optional<double> tracked_amplitude_error(const TrajectoryInfo& info);

/// The clause that says how the drive in the film differs from the stated one; empty if it does not. No value
/// if there was no check.
std::optional<std::string> recorded_disagreement(const TrajectoryInfo& info);

}  // namespace twincell
