#pragma once
/// \file
/// Identities through the frames of a shaken cell.
///
/// Each track says where its bead should be now. Three rules are tried on every frame: where the bead was;
/// there plus its last step; where it was a cycle ago plus what it has drifted since. The first, which
/// remembers no error, is taken unless another fits the frame better. What the prediction lacks is learnt
/// from the frame itself, first for all beads together (a bed that flies or rides on the plate moves as one),
/// then from neighbours that are already settled (a bed that lands is stopped from below). A detection within
/// 0.25 d of where it is expected has no rival, since discs do not overlap; most beads are settled by this
/// one look. The rest is assigned so that the summed cost is least (assignment.hpp), and the cost by which
/// the next best assignment is more expensive says which links are ambiguous.
///
/// Frames in which neighbours part are matched anew, all beads at once (collective_matching.hpp), and once
/// more with what the frame ahead tells: a bead that is hit once between two frames has gone part of the step
/// that free flight repeats and the rest of the step back from where it goes next.
///
/// Pictures have gravity downwards: y grows in a fall, and nothing is expected below the lowest detection.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "imaging/geometry/pixel_frame.hpp"

namespace twincell {

/// How identities are kept.
struct LinkOptions {
  double diameter_px = 0;            ///< bead diameter, > 0
  double range_diameters = 2;        ///< longest step from the predicted place, diameters, > 0, <= 10
  int memory = 3;                    ///< frames for which a bead may be missing, 0 .. 1000
  double max_shift_diameters = 1.5;  ///< largest common departure from the prediction sought, diameters,
                                     ///< 0 .. 10; 0: none
  double fall_px = 0;  ///< by which a step downwards grows per frame interval in free flight: g dt^2; >= 0
  bool closed =
      false;  ///< no bead comes or goes: as many detections as tracks, none missing, are all of them
  double ambiguous_odds = 20;  ///< a link is ambiguous below these odds against the next best, >= 1
};

/// What is known of a frame besides its beads.
struct FrameMoment {
  double interval = 1;      ///< frame intervals since the frame before; 2: one was dropped, 0: taken twice
  std::int32_t phase = -1;  ///< phase of the drive, -1: not phase-locked
  std::int64_t cycle = -1;  ///< cycle of the drive
};

/// The frame after the one that is linked.
struct FrameAhead {
  std::span<const PixelPoint> detections;
  FrameMoment moment;
  std::span<const std::uint8_t> tracers;  ///< as for `Linker::next`
};

/// What the linker did, in one frame or summed over frames.
struct LinkReport {
  std::int64_t frames = 0;
  std::int64_t links = 0;            ///< detections that continue a track
  std::int64_t settled = 0;          ///< of them, those settled by one look
  std::int64_t bridged = 0;          ///< of them, those whose track was missing in between
  std::int64_t ambiguous = 0;        ///< of them, those whose odds against the next best are below the bound
  std::int64_t births = 0;           ///< detections that begin a track
  std::int64_t losses = 0;           ///< tracks given up
  std::int64_t networks = 0;         ///< sub-networks assigned
  std::int64_t largest_network = 0;  ///< tracks in the largest
  std::int64_t unsolved = 0;         ///< tracks left to the fallback because a frame was too crowded
  std::int64_t rematched = 0;        ///< frames matched anew because neighbours parted
  std::int64_t unclear_shifts = 0;   ///< frames whose common shift had a rival nearly as good
  void add(const LinkReport& frame);
};

/// Links frame after frame; memory is one entry per living track (and 16 bytes per phase of the cycle).
class Linker {
 public:
  /// Cycles of more phases are not remembered.
  static constexpr int kMostPhases = 512;
  /// \throws ConfigError if an option is out of range
  explicit Linker(const LinkOptions& options, int phases_per_cycle = 0);
  /// Gives each detection of the next frame its track: old numbers go on, new ones are counted from 0.
  /// \param tracers 1 for a tracer bead, or empty; a track prefers detections of its own kind
  /// \param ahead the frame after, where it is known: in a frame that is matched anew, a link is also judged
  ///     by how its bead goes on. Beads that collide between two frames are told by nothing else
  /// \throws RunError if a place is not finite or lies 10^9 px away
  std::vector<std::int64_t> next(std::span<const PixelPoint> detections, const FrameMoment& moment = {},
                                 std::span<const std::uint8_t> tracers = {},
                                 const FrameAhead* ahead = nullptr);
  /// Steps, px per frame interval, with which the beads of the first frame come into it, in its order; NaN
  /// where it is not known. To be said before that frame (initial_velocities.hpp finds them).
  void begin(std::vector<PixelPoint> steps) { first_steps_ = std::move(steps); }
  /// The same tracks on their way back, to link the frames before the last one in falling order; what they
  /// were a cycle ago is forgotten.
  [[nodiscard]] Linker turned() const;
  /// Of the last frame, per detection: 1 if its link is ambiguous.
  [[nodiscard]] const std::vector<std::uint8_t>& ambiguous() const { return ambiguous_; }
  /// Tracks so far.
  [[nodiscard]] std::int64_t n_tracks() const { return n_tracks_; }
  /// Median step of the beads linked in the last frame, px.
  [[nodiscard]] PixelPoint common_step() const { return step_; }
  /// Mean step of the beads linked in the last frame, px.
  [[nodiscard]] PixelPoint mean_step() const { return mean_step_; }
  /// Of the last frame, and of all.
  [[nodiscard]] const LinkReport& last() const { return last_; }
  [[nodiscard]] const LinkReport& total() const { return total_; }

 private:
  struct Track {
    std::int64_t id = 0;
    PixelPoint place;  // last seen; moved along with the common step while missing
    PixelPoint step;   // per frame interval
    PixelPoint drift;  // against the same phase of the cycle before; 0 where that is unknown
    std::int32_t missed = 0;
    std::int32_t seen = 1;        // frames
    std::int32_t detection = -1;  // in the frame last seen
    std::uint8_t tracer = 0;
  };
  struct Way {
    double miss2;   // squared distance from it, diameters squared
    double length;  // diameters
  };
  enum class Rule { still, step, cycle };
  class Grid;

  [[nodiscard]] PixelPoint predict(std::size_t track, Rule rule, const FrameMoment& moment) const;
  [[nodiscard]] PixelPoint in_flight(std::size_t track, const FrameMoment& moment) const;
  void predict_all(const Grid& grid, const FrameMoment& moment);
  void settle(const Grid& grid, std::span<const std::uint8_t> tracers);
  void follow_neighbours(const Grid& grid);
  void link(std::span<const PixelPoint> detections, const FrameMoment& moment,
            std::span<const std::uint8_t> tracers, const FrameAhead* ahead);
  [[nodiscard]] bool neighbours_part(const Grid& grid) const;
  [[nodiscard]] bool stranger(const Track& track) const;
  [[nodiscard]] double price_of_nowhere(std::size_t track) const;
  [[nodiscard]] std::vector<std::uint8_t> newcomers(const Grid& grid) const;
  [[nodiscard]] bool all_there(const Grid& grid) const;
  [[nodiscard]] std::vector<PixelPoint> steps_back(const Grid& grid, std::span<const PixelPoint> detections,
                                                   const FrameMoment& moment,
                                                   std::span<const std::uint8_t> tracers,
                                                   const FrameAhead& ahead) const;
  [[nodiscard]] Way way(std::size_t track, PixelPoint to, PixelPoint step_back) const;
  [[nodiscard]] bool flies_on(const Grid& grid, const std::vector<PixelPoint>& steps_back) const;
  void match_all(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameMoment& moment,
                 const std::vector<PixelPoint>& steps_back);
  void link_left_over(const Grid& grid);
  void say_ambiguous(std::size_t detection);
  void assign_rest(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameMoment& moment);
  void update(std::span<const PixelPoint> detections, std::span<const std::uint8_t> tracers,
              const FrameMoment& moment, std::vector<std::int64_t>& ids);

  LinkOptions options_;
  int phases_;
  std::vector<Track> tracks_;
  std::vector<PixelPoint> cycle_places_;      // [track][phase]: place at that phase, last time
  std::vector<std::int64_t> cycle_of_phase_;  // when that was
  std::int64_t n_tracks_ = 0;
  PixelPoint step_, mean_step_;
  PixelPoint low_{1e9, 1e9}, high_{-1e9, -1e9};  // corners of where detections have been
  std::vector<PixelPoint> first_steps_;          // of the detections of the first frame; empty: not known
  std::vector<std::uint8_t> ambiguous_;
  LinkReport last_, total_;

  // Of the frame at hand.
  std::vector<PixelPoint> expected_;        // per track
  std::vector<PixelPoint> falling_;         // per track, the same as if there were no floor
  std::vector<PixelPoint> flying_;          // per track, where free flight leads
  std::vector<double> disputed_;            // per track, px from where free flight leads to another detection
  std::vector<PixelPoint> local_;           // per track, the correction learnt from settled neighbours
  std::vector<std::int32_t> detection_of_;  // per track, -1: none yet
  std::vector<std::int32_t> track_of_;      // per detection, -1: none yet
};

}  // namespace twincell
