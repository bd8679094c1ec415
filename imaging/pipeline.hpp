#pragma once
/// \file
/// Stack -> bead table, stack -> trajectory.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "analysis/trajectory/progress.hpp"
#include "analysis/trajectory/trajectory.hpp"
#include "imaging/cell.hpp"
#include "imaging/frame_source.hpp"
#include "imaging/link.hpp"
#include "imaging/locator.hpp"

namespace twincell {

/// Takes one located frame: its number from 0, the grey frame, what was found.
using LocatedSink = std::function<void(std::int64_t frame, const cv::Mat& grey, const Located& located)>;

/// Locates every frame of a stack, `threads` frames at a time; the sink is called in the order of the frames,
/// by the calling thread, and sees the same whatever the number of threads. If options.diameter_px is 0 it is
/// estimated from the first frame and written there. Memory: a few frames. \returns the number of frames
/// \throws InputError if the stack holds no frame, cannot be read, or shows no discs to estimate a diameter
/// from
std::int64_t locate_stack(FrameSource& frames, LocatorOptions& options, int threads, const LocatedSink& sink,
                          Progress& progress = Progress::none());

/// One bead of one frame on its way to a trajectory.
struct TrackedBead {
  double x_px = 0, y_px = 0, radius_px = 0;
  std::int64_t track = -1;
  bool tracer = false;
};

/// A stack located and linked; the pictures are gone, about 40 bytes per bead and frame remain.
struct TrackedStack {
  std::vector<std::vector<TrackedBead>> frames;
  std::int64_t n_tracks = 0;
  int width_px = 0, height_px = 0;
  std::size_t outside_cell = 0;  ///< detections left out because the cell does not reach there
};

/// Locates and links. \param cell detections more than half a bead outside its walls are counted and left
/// out; needs origin, scale and size for that, otherwise all stay
TrackedStack track_stack(FrameSource& frames, LocatorOptions& locator, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress = Progress::none());

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

/// Writes the frames. Time is in t0 where the drive and N_k are known (a period per N_k frames), else the
/// frame number. Velocity is absent; the plate height is there where the drive is known.
void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell,
                      TrajectorySink& sink);

}  // namespace twincell
