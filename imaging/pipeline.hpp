#pragma once
/// \file
/// Stack -> bead table, stack -> trajectory.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/trajectory/progress.hpp"
#include "analysis/trajectory/trajectory.hpp"
#include "imaging/bead_spool.hpp"
#include "imaging/cell.hpp"
#include "imaging/frame_source.hpp"
#include "imaging/link.hpp"
#include "imaging/locator.hpp"
#include "imaging/phase_lock.hpp"

namespace twincell {

/// Takes one located frame: its number from 0, the grey frame, what was found.
using LocatedSink = std::function<void(std::int64_t frame, const cv::Mat& grey, const Located& located)>;

/// What became of a stack.
struct LocatedStack {
  std::int64_t frames = 0;
  std::int64_t settings_frame = 0;  ///< from which what the options left open was found
};

/// Locates every frame of a stack, `threads` frames at a time; the sink is called in the order of the frames,
/// by the calling thread, and sees the same whatever the number of threads. What options leave open
/// (diameter, polarity) is found from the first of frames 0, 1, 2, 4, ... 32 that shows beads, and written
/// there. Memory: a few frames, and those without beads at the beginning. \throws InputError if the stack
/// holds no frame, cannot be read, or shows no discs to estimate a diameter from
LocatedStack locate_stack(FrameSource& frames, LocatorOptions& options, int threads, const LocatedSink& sink,
                          Progress& progress = Progress::none());

/// How a stack's phases are learnt. With neither: from the cell's frames per cycle.
struct PhaseWay {
  bool find = false;                              ///< from the bed's own motion (found_phase.hpp)
  std::optional<std::filesystem::path> triggers;  ///< from a list (trigger_list.hpp)
  std::optional<double> drive_hz;                 ///< frequency of the drive, for a list in seconds
};

/// What is known of a track when the stack ends.
struct TrackSummary {
  std::int64_t first = 0, last = 0;  ///< frames in which it was seen
  std::int64_t seen = 0;             ///< number of frames
  std::int64_t tracer = 0;           ///< of them, those in which the bead looked like a tracer
  std::int64_t ambiguous = 0;        ///< of its links, those that are
  double radius_px = 0;              ///< mean
  [[nodiscard]] bool is_tracer() const { return 2 * tracer > seen; }
};

/// A stack located and linked. The beads are on disk; in memory are about 50 bytes per track and 24 per
/// frame.
struct TrackedStack {
  BeadSpool frames;  ///< frames[f]: the beads of frame f
  std::vector<TrackSummary> tracks;
  std::int64_t n_tracks = 0;
  int width_px = 0, height_px = 0;
  std::size_t outside_cell = 0;  ///< detections left out because the cell does not reach there
  std::size_t wrong_radius = 0;  ///< candidates left out as discs of another size
  PhaseTable phases;
  LinkReport links;

  /// Tracers (by majority) that are not seen from the first frame to the last: their identity was lost, or
  /// they came or went.
  [[nodiscard]] std::vector<std::int64_t> broken_tracers() const;
};

/// Locates, finds phases, links; the stack is read once. Frames taken twice are linked without a step.
/// \param cell detections more than half a bead outside its walls are counted and left out, which needs
///     origin, scale and size, otherwise all stay; drive, frames per cycle and scale tell the linker how fast
///     beads fall
/// \param spool_folder where the beads wait on disk, about 64 bytes per bead and frame; empty: the folder for
/// temporary files
/// \throws InputError if a list of triggers does not have a line for each frame
TrackedStack track_stack(FrameSource& frames, LocatorOptions& locator, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress = Progress::none(),
                         const PhaseWay& way = {}, const std::filesystem::path& spool_folder = {});

/// The part of `track_stack` behind the locator: phases and identities for the beads of a spool.
TrackedStack link_spool(const BeadSpool& located, LinkOptions link, const CellDescription& cell,
                        const PhaseWay& way, const std::filesystem::path& spool_folder,
                        Progress& progress = Progress::none());

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
