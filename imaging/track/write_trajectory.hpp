#pragma once
/// \file
/// Writes a tracked stack as a trajectory.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "imaging/cell/cell.hpp"
#include "imaging/track/track.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::imaging {

/// Metadata and bead slots of a trajectory made from a stack. Lengths are in sigma; sigma is
/// cell.pixels_per_sigma or, if that is unknown, the located diameter. The origin is the cell's or, if that
/// is unknown, the lower left corner of the picture. `slot_of_track[t]` is the slot of track t, or -1 for a
/// track with fewer than `shortest` frames or in the plate.
struct TrackPlan {
  TrajectoryInfo info;
  PixelFrame pixel_frame;
  std::vector<std::int64_t> slot_of_track;
  std::size_t in_plate = 0;  ///< tracks without a slot because they lie in the plate (beneath_plate.hpp)
  /// A sentence on them; empty if there are none.
  [[nodiscard]] std::string in_plate_note() const;
};
/// Plans the trajectory of a tracked stack: its metadata, the map from px to sigma, and the slots of the
/// tracks.
/// \param diameter_px located diameter, px
/// \param shortest fewest frames of a track that gets a slot
TrackPlan plan_trajectory(const TrackedStack& stack, const CellDescription& cell, double diameter_px,
                          int shortest);

/// Report of the tracking: method and quality of the phases, links, ambiguous links, tracers, and the map of
/// the camera, with its covariance if a calibration supplied one. It is stored in the trajectory
/// as TrajectoryInfo::tracking_json (docs/h5md.md). It names slots, not tracks.
nlohmann::json tracking_report(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell);

/// Writes the frames one by one. Time is in t0 if the drive and N_k are known (one period per N_k frames),
/// otherwise it is the frame number. Velocity is absent. The plate height is present if the drive and the
/// phases are known. A frame that was taken twice is written once.
void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, TrajectorySink& sink);

}  // namespace twincell::imaging
