#pragma once
/// \file
/// The tracks between two frames: where each bead was last detected and how it moved.

#include <cstdint>
#include <span>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"
#include "imaging/link/link_options.hpp"

namespace twincell::imaging {

/// One bead.
struct Track {
  std::int64_t id = 0;
  PixelPoint place;  ///< last detected position; moves with the common step while the bead is missing
  PixelPoint step;   ///< per frame interval
  PixelPoint drift;  ///< since the same phase of the previous cycle; 0 if unknown
  std::int32_t missed = 0;
  std::int32_t seen = 1;        ///< number of frames in which it was detected
  std::int32_t detection = -1;  ///< index in the frame in which it was last detected
  std::uint8_t tracer = 0;
};

/// The rules that predict a track's next position.
enum class PredictionRule {
  still,  ///< the last position
  step,   ///< the last position plus the last step
  cycle,  ///< the position one cycle ago plus the drift since then; `step` where that is unknown
};

/// All tracks, and what they have in common.
struct Tracks {
  int phases = 0;                            ///< per cycle; 0: not phase-locked
  std::vector<Track> active;                 ///< those that may still be detected
  std::vector<PixelPoint> cycle_places;      ///< [track][phase]: last position at that phase
  std::vector<std::int64_t> cycle_of_phase;  ///< cycle in which that was
  std::int64_t numbered = 0;                 ///< number of tracks so far
  std::int64_t frames = 0;                   ///< number of frames so far
  PixelPoint step, mean_step;                ///< median and mean over the beads linked in the last frame, px
  PixelPoint low{1e9, 1e9}, high{-1e9, -1e9};  ///< corners of the bounding box of all detections so far
  std::vector<PixelPoint> first_steps;         ///< of the detections of the first frame; empty: unknown

  /// Whether the positions of the previous cycle at the phase of a frame are known.
  [[nodiscard]] bool remember(const FrameTime& time) const;
  /// Predicted position of a track, px.
  /// \pre for the rule `cycle`: time.phase < phases
  [[nodiscard]] PixelPoint predict(std::size_t track, PredictionRule rule, const FrameTime& time) const;
  /// Position of a track in free flight: the step repeats itself and grows by the fall.
  [[nodiscard]] PixelPoint in_flight(std::size_t track, double fall_px, const FrameTime& time) const;
  /// Whether a track is unconfirmed. A track that began one frame ago may be no bead: a speck of dust visible
  /// in one frame must not take the detection of a bead.
  [[nodiscard]] bool is_unconfirmed(const Track& track) const { return track.seen == 1 && frames > 1; }
  /// The same tracks in reversed time; positions of the previous cycle are discarded.
  [[nodiscard]] Tracks reversed(double fall_px) const;
};

/// Last positions of tracks.
std::vector<PixelPoint> places_of(const std::vector<Track>& tracks);

/// The links of one frame.
struct FrameLinks {
  std::span<const PixelPoint> detections;
  FrameTime time;
  std::span<const std::uint8_t> tracers;       ///< as for `Linker::next` (link.hpp)
  std::span<const std::int32_t> detection_of;  ///< per track, -1: not detected
};

/// Updates the tracks from the links of a frame: linked tracks take the new positions, missing tracks move
/// with the common step and end after `memory` frames, detections without a track begin one. `frames` is
/// unchanged.
/// \param report links, bridged, losses and births are added to it
/// \returns the number of the track of each detection
std::vector<std::int64_t> update(Tracks& tracks, const FrameLinks& links, int memory, LinkReport& report);

}  // namespace twincell::imaging
