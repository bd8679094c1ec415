#pragma once
/// \file
/// One frame while it is linked: its detections, the expected positions of the tracks, and the links so far.
/// The steps of the linker hand one FrameMatch on (link.cpp): predict → settle → follow neighbours → assign
/// the rest → match collectively → link what is left over.

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "imaging/link/link_options.hpp"
#include "imaging/link/point_grid.hpp"
#include "imaging/link/tracks.hpp"

namespace twincell::imaging {

/// Links of the tracks before a frame to the detections in it. Detections are numbered in the order of the
/// grid, except in `ambiguous`.
struct FrameMatch {
  FrameMatch(const LinkOptions& link_options, const Tracks& tracks_before,
             std::span<const PixelPoint> frame_detections, const FrameTime& frame_time,
             std::span<const std::uint8_t> tracers_or_none)
      : options(link_options),
        before(tracks_before),
        tracks(tracks_before.active),
        detections(frame_detections, 1.1 * link_options.diameter_px),
        time(frame_time),
        tracers(tracers_or_none),
        detection_of(tracks.size(), -1),
        track_of(frame_detections.size(), -1),
        ambiguous(frame_detections.size(), 0) {}

  const LinkOptions& options;
  const Tracks& before;
  const std::vector<Track>& tracks;  ///< the active ones
  PointGrid detections;
  FrameTime time;
  std::span<const std::uint8_t> tracers;  ///< in the order given; or empty

  // Predictions, per track; px.
  std::vector<PixelPoint> expected;              ///< expected position
  std::vector<PixelPoint> expected_no_floor;     ///< the same without the floor
  std::vector<PixelPoint> ballistic;             ///< position in free flight
  std::vector<double> rival_distance;            ///< of a rival detection from the position in free flight
  std::vector<PixelPoint> neighbour_correction;  ///< estimated from linked neighbours; NaN: unknown

  // Links.
  std::vector<std::int32_t> detection_of;  ///< per track, -1: not yet linked
  std::vector<std::int32_t> track_of;      ///< per detection, -1: not yet linked
  std::vector<std::uint8_t> ambiguous;     ///< per detection in the order given: 1 if its link is ambiguous
  LinkReport report{.frames = 1};

  /// The detection of a linked track.
  [[nodiscard]] PixelPoint detected(std::size_t track) const {
    return detections[static_cast<std::size_t>(detection_of[track])];
  }
  /// Whether linking would make a tracer of a bead or a bead of a tracer.
  [[nodiscard]] bool changes_type(std::size_t track, std::size_t detection) const {
    return !tracers.empty() && tracers[detections.original(detection)] != tracks[track].tracer;
  }
  /// Marks the link of a detection as ambiguous.
  void mark_ambiguous(std::size_t detection) {
    if (std::exchange(ambiguous[detections.original(detection)], std::uint8_t{1}) == 0) ++report.ambiguous;
  }
  /// Whether there are as many detections as tracks and no track is missing or unconfirmed.
  [[nodiscard]] bool is_complete() const {
    return detections.size() == tracks.size() &&
           std::all_of(tracks.begin(), tracks.end(),
                       [&](const Track& t) { return t.missed == 0 && !before.is_unconfirmed(t); });
  }
};

}  // namespace twincell::imaging
