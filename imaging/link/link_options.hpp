#pragma once
/// \file
/// Input and report of the linker: options, the time of a frame, the frame ahead, and counts.

#include <cstdint>
#include <span>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// A link is ambiguous if its odds against the second-best are lower.
inline constexpr double kAmbiguousOdds = 20;

/// Options of the linker.
struct LinkOptions {
  double diameter_px = 0;      ///< bead diameter, > 0
  double range_diameters = 2;  ///< longest step from the predicted position, diameters, > 0, <= 10
  int memory = 3;              ///< frames for which a bead may be missing, 0 .. 1000
  /// Largest common shift from the prediction that is searched for, diameters, 0 .. 10; 0: no search.
  double max_shift_diameters = 1.5;
  /// Increase of the downward step per frame interval in free flight: g dt^2, px, >= 0.
  double fall_px = 0;
  /// No bead enters or leaves: with as many detections as tracks and none missing, all are seen.
  bool closed = false;
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
  std::span<const std::uint8_t> tracers;  ///< as for `Linker::next` (link.hpp)
};

/// Counts of the linker's actions, in one frame or summed over frames.
struct LinkReport {
  std::int64_t frames = 0;
  std::int64_t links = 0;      ///< detections that continue a track
  std::int64_t settled = 0;    ///< of them, those settled by the single lookup
  std::int64_t bridged = 0;    ///< of them, those whose track was missing in between
  std::int64_t ambiguous = 0;  ///< of them, those whose odds against the second-best are below kAmbiguousOdds
  std::int64_t births = 0;     ///< detections that start a track
  std::int64_t losses = 0;     ///< tracks that ended
  std::int64_t edges = 0;      ///< possible links of the tracks that the single lookup left open
  std::int64_t networks = 0;   ///< sub-networks assigned
  std::int64_t largest_network = 0;  ///< tracks in the largest
  std::int64_t unsolved = 0;   ///< tracks left to the fallback because the assignment exceeded its work bound
  std::int64_t rematched = 0;  ///< frames matched again, all beads at once
  std::int64_t unclear_shifts = 0;  ///< frames in which a second common shift fits nearly as well
  /// Adds the counts of a frame; of largest_network, the larger one is kept.
  void add(const LinkReport& frame);
};

}  // namespace twincell::imaging
