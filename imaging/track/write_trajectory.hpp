#pragma once
/// \file
/// From a tracked stack to a trajectory.

#include <cstdint>
#include <string>
#include <vector>

#include "imaging/cell/cell.hpp"
#include "imaging/track/track.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// What a trajectory made from a stack will say of itself. Lengths are in sigma with sigma =
/// cell.pixels_per_sigma or, where that is unknown, the located diameter; the origin is the cell's or, where
/// that is unknown, the lower left corner of the picture. `slot_of_track[t]` is the slot of track t, or -1
/// for a track shorter than `shortest` frames.
struct TrackPlan {
  TrajectoryInfo info;
  PixelFrame pixel_frame;
  std::vector<std::int64_t> slot_of_track;
};
TrackPlan plan_trajectory(const TrackedStack& stack, const CellDescription& cell, double diameter_px,
                          int shortest);

/// What the tracking says of itself, as JSON: way and quality of the phases, links, ambiguous links, tracers.
/// map of the camera with its covariance where a calibration gave it. It is stored in the trajectory
/// (docs/h5md.md). Slots, not tracks, are named.
std::string tracking_json(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell);

/// Writes the frames, one at a time. Time is in t0 where the drive and N_k are known (a period per N_k
/// frames), else the frame number. Velocity is absent; the plate height is there where the drive is known. A
/// frame that was taken twice is written once.
void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell,
                      TrajectorySink& sink);

}  // namespace twincell
