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
/// A frame in which neighbours separate is matched again, all beads at once (collective_matching.hpp), and
/// then a second time with the next frame as evidence: a bead that is hit once between two frames covers a
/// fraction of the step that free flight would repeat, and the remaining fraction of the step implied by its
/// motion to the next frame.
///
/// In the picture gravity points down: y increases in a fall, and no bead is expected below the lowest
/// detection.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "imaging/geometry/pixel_frame.hpp"

namespace twincell {

/// Options of the linker.
struct LinkOptions {
  double diameter_px = 0;            ///< bead diameter, > 0
  double range_diameters = 2;        ///< longest step from the predicted position, diameters, > 0, <= 10
  int memory = 3;                    ///< frames for which a bead may be missing, 0 .. 1000
  double max_shift_diameters = 1.5;  ///< largest common shift from the prediction that is searched for,
                                     ///< diameters, 0 .. 10; 0: no search
  double fall_px = 0;  ///< increase of the downward step per frame interval in free flight: g dt^2, px, >= 0
  bool closed =
      false;  ///< no bead enters or leaves: with as many detections as tracks and none missing, all are seen
  double ambiguous_odds = 20;  ///< a link is ambiguous if its odds against the second-best are lower, >= 1
};

/// Time of a frame relative to the previous frame and to the drive.
struct FrameTime {
  double interval = 1;      ///< frame intervals since the previous frame; 2: one was dropped, 0: taken twice
  std::int32_t phase = -1;  ///< phase of the drive, -1: not phase-locked
  std::int64_t cycle = -1;  ///< cycle of the drive
};

/// The frame after the one being linked.
struct FrameAhead {
  std::span<const PixelPoint> detections;
  FrameTime time;
  std::span<const std::uint8_t> tracers;  ///< as for `Linker::next`
};

/// Counts of the linker's actions, in one frame or summed over frames.
struct LinkReport {
  std::int64_t frames = 0;
  std::int64_t links = 0;      ///< detections that continue a track
  std::int64_t settled = 0;    ///< of them, those settled by the single lookup
  std::int64_t bridged = 0;    ///< of them, those whose track was missing in between
  std::int64_t ambiguous = 0;  ///< of them, those whose odds against the second-best are below the bound
  std::int64_t births = 0;     ///< detections that start a track
  std::int64_t losses = 0;     ///< tracks that ended
  std::int64_t networks = 0;   ///< sub-networks assigned
  std::int64_t largest_network = 0;  ///< tracks in the largest
  std::int64_t unsolved = 0;   ///< tracks left to the fallback because the assignment exceeded its work bound
  std::int64_t rematched = 0;  ///< frames matched again, all beads at once
  std::int64_t unclear_shifts = 0;  ///< frames in which a second common shift fits nearly as well
  void add(const LinkReport& frame);
};

/// Links frame after frame. Memory: one entry per active track, and 16 bytes per track and phase of the
/// cycle.
class Linker {
 public:
  /// The rule "one cycle ago" is disabled for cycles with more phases.
  static constexpr int kMostPhases = 512;
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
  void begin(std::vector<PixelPoint> steps) { first_steps_ = std::move(steps); }
  /// Returns a linker with the same tracks in reversed time, to link the frames before the last one in
  /// descending order. Positions of the previous cycle are discarded.
  [[nodiscard]] Linker reversed() const;
  /// For each detection of the last frame: 1 if its link is ambiguous.
  [[nodiscard]] const std::vector<std::uint8_t>& ambiguous() const { return ambiguous_; }
  /// Number of tracks so far.
  [[nodiscard]] std::int64_t n_tracks() const { return n_tracks_; }
  /// Median step of the beads linked in the last frame, px.
  [[nodiscard]] PixelPoint common_step() const { return step_; }
  /// Mean step of the beads linked in the last frame, px.
  [[nodiscard]] PixelPoint mean_step() const { return mean_step_; }
  /// Counts of the last frame, and of all frames.
  [[nodiscard]] const LinkReport& last() const { return last_; }
  [[nodiscard]] const LinkReport& total() const { return total_; }

 private:
  struct Track {
    std::int64_t id = 0;
    PixelPoint place;  // last detected position; moves with the common step while the bead is missing
    PixelPoint step;   // per frame interval
    PixelPoint drift;  // since the same phase of the previous cycle; 0 if unknown
    std::int32_t missed = 0;
    std::int32_t seen = 1;        // number of frames in which it was detected
    std::int32_t detection = -1;  // index in the frame in which it was last detected
    std::uint8_t tracer = 0;
  };
  struct CollisionPath {
    double miss2;   // squared distance of the detection from the one-collision line, diameters squared
    double length;  // of that line, diameters
  };
  enum class PredictionRule { still, step, cycle };
  class Grid;

  [[nodiscard]] PixelPoint predict(std::size_t track, PredictionRule rule, const FrameTime& time) const;
  [[nodiscard]] PixelPoint in_flight(std::size_t track, const FrameTime& time) const;
  void predict_all(const Grid& grid, const FrameTime& time);
  void settle(const Grid& grid, std::span<const std::uint8_t> tracers);
  void follow_neighbours(const Grid& grid);
  void link(std::span<const PixelPoint> detections, const FrameTime& time,
            std::span<const std::uint8_t> tracers, const FrameAhead* ahead);
  [[nodiscard]] bool neighbours_separate(const Grid& grid) const;
  [[nodiscard]] bool is_unconfirmed(const Track& track) const;
  [[nodiscard]] double cost_of_no_match(std::size_t track) const;
  [[nodiscard]] std::vector<std::uint8_t> newcomers(const Grid& grid) const;
  [[nodiscard]] bool is_complete(const Grid& grid) const;
  [[nodiscard]] std::vector<PixelPoint> steps_back(const Grid& grid, std::span<const PixelPoint> detections,
                                                   const FrameTime& time,
                                                   std::span<const std::uint8_t> tracers,
                                                   const FrameAhead& ahead) const;
  [[nodiscard]] CollisionPath collision_path(std::size_t track, PixelPoint to, PixelPoint step_back) const;
  [[nodiscard]] bool follows_ballistic(const Grid& grid, const std::vector<PixelPoint>& steps_back) const;
  void match_all(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameTime& time,
                 const std::vector<PixelPoint>& steps_back);
  void link_left_over(const Grid& grid);
  void mark_ambiguous(std::size_t detection);
  void assign_rest(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameTime& time);
  void update(std::span<const PixelPoint> detections, std::span<const std::uint8_t> tracers,
              const FrameTime& time, std::vector<std::int64_t>& ids);

  LinkOptions options_;
  int phases_;
  std::vector<Track> tracks_;
  std::vector<PixelPoint> cycle_places_;      // [track][phase]: last position at that phase
  std::vector<std::int64_t> cycle_of_phase_;  // cycle in which that was
  std::int64_t n_tracks_ = 0;
  PixelPoint step_, mean_step_;
  PixelPoint low_{1e9, 1e9}, high_{-1e9, -1e9};  // corners of the bounding box of all detections so far
  std::vector<PixelPoint> first_steps_;          // of the detections of the first frame; empty: unknown
  std::vector<std::uint8_t> ambiguous_;
  LinkReport last_, total_;

  // State of the current frame.
  std::vector<PixelPoint> expected_;           // per track
  std::vector<PixelPoint> expected_no_floor_;  // per track, the same without the floor
  std::vector<PixelPoint> ballistic_;          // per track, the position in free flight
  std::vector<double>
      rival_distance_;  // per track, distance of a rival detection from the position in free flight, px
  std::vector<PixelPoint>
      neighbour_correction_;                // per track, the correction estimated from linked neighbours
  std::vector<std::int32_t> detection_of_;  // per track, -1: not yet linked
  std::vector<std::int32_t> track_of_;      // per detection, -1: not yet linked
};

}  // namespace twincell
