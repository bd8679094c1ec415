#pragma once
/// \file
/// Tracking: bead identities across the frames of a shaken cell.
///
/// Each track predicts the present position of its bead. Three rules are tried on every frame: the bead's
/// last position; that position plus its last step; its position one cycle ago plus its drift since then. The
/// first rule, which accumulates no error, is used unless another fits the frame better. The remaining
/// displacement is estimated from the frame itself: first for all beads together (a bed that is airborne or
/// rides on the plate moves as one), then from neighbours that are already linked (a bed that lands is
/// stopped from below). A detection within 0.25 d of its expected position has no rival, since discs do not
/// overlap; this single lookup settles most beads. The remaining tracks are assigned at minimum total cost
/// (assignment.hpp). The cost margin to the second-best assignment determines which links are ambiguous.
///
/// A frame in which neighbours separate, or with a link that remains ambiguous, is matched again, all beads
/// at once (collective_matching.hpp). If beads follow ballistic paths and the next frame is given, the frame
/// is then matched with the next frame as evidence. A bead that collides once between two frames covers a
/// fraction of the step that free flight would repeat, and the remaining fraction of the step implied by its
/// motion to the next frame.
///
/// In the picture gravity points down: y increases in a fall, and no bead is expected below the lowest
/// detection.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "imaging/link/link_options.hpp"
#include "imaging/link/tracks.hpp"

namespace twincell::imaging {

/// Links frame after frame. Memory: one entry per active track, and 16 bytes per track and phase of the
/// cycle.
class Linker {
 public:
  /// The rule "one cycle ago" is disabled for cycles with more phases.
  static constexpr int kMaxPhases = 512;
  /// \throws ConfigError if an option is out of range
  explicit Linker(const LinkOptions& options, int phases_per_cycle = 0);
  /// Returns the track of each detection in the next frame. Existing tracks keep their numbers; new ones are
  /// numbered consecutively from 0.
  /// \param tracers 1 for a tracer bead, or empty; a track prefers detections of its own kind
  /// \param ahead the frame after the next one, if available: if the frame is matched collectively, each link
  ///     is also judged by the bead's motion after it. This is the only evidence for a collision between two
  ///     frames
  /// \throws RunError if a coordinate is not finite or is 10^9 px or more
  std::vector<std::int64_t> next(std::span<const PixelPoint> detections, const FrameTime& time = {},
                                 std::span<const std::uint8_t> tracers = {},
                                 const FrameAhead* ahead = nullptr);
  /// Sets the steps, px per frame interval, with which the beads of the first frame arrive there, in the
  /// order of its detections; NaN where unknown. Call it before that frame (initial_velocities.hpp computes
  /// the steps).
  void begin(std::vector<PixelPoint> steps) { tracks_.first_steps = std::move(steps); }
  /// Returns a linker with the same tracks in reversed time, to link the frames before the last one in
  /// descending order. Positions of the previous cycle are discarded.
  [[nodiscard]] Linker reversed() const;
  /// For each detection of the last frame: 1 if its link is ambiguous.
  [[nodiscard]] const std::vector<std::uint8_t>& ambiguous() const { return ambiguous_; }
  /// Number of tracks so far.
  [[nodiscard]] std::int64_t n_tracks() const { return tracks_.numbered; }
  /// Mean step of the beads linked in the last frame, px.
  [[nodiscard]] PixelPoint mean_step() const { return tracks_.mean_step; }
  /// Counts of the last frame, and of all frames.
  [[nodiscard]] const LinkReport& last() const { return last_; }
  [[nodiscard]] const LinkReport& total() const { return total_; }

 private:
  LinkOptions options_;
  Tracks tracks_;
  std::vector<std::uint8_t> ambiguous_;
  LinkReport last_, total_;
};

}  // namespace twincell::imaging
