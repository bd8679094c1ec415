#pragma once
/// \file
/// The unit of Frame::time.

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Whether Frame::time is the number of the frame instead of a time in t0: a tracked film whose drive or
/// frames per cycle are unknown.
inline bool time_is_frame_number(const TrajectoryInfo& info) {
  return !info.tracking_json.empty() && !info.columns.plate_height;
}

}  // namespace twincell
