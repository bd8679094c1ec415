#include "imaging/link/link.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "imaging/link/assign_open_tracks.hpp"
#include "imaging/link/direct_links.hpp"
#include "imaging/link/frame_match.hpp"
#include "imaging/link/link_costs.hpp"
#include "imaging/link/predict.hpp"
#include "imaging/link/rematch.hpp"

namespace twincell::imaging {

namespace {

void require_places(std::span<const PixelPoint> detections, std::int64_t frame) {
  constexpr double kMaxCoordinate = 1e9;  // px, beyond any camera
  for (std::size_t k = 0; k < detections.size(); ++k)
    if (!(std::abs(detections[k].x_px) < kMaxCoordinate && std::abs(detections[k].y_px) < kMaxCoordinate))
      throw RunError(fmt::format("frame {}, detection {}: ({}, {}) is not a position in a picture.", frame, k,
                                 detections[k].x_px, detections[k].y_px));
}

/// The links with detections in the order given instead of that of the grid.
std::vector<std::int32_t> in_order_given(const FrameMatch& m) {
  std::vector<std::int32_t> detection_of = m.detection_of;
  for (std::int32_t& k : detection_of)
    if (k >= 0) k = static_cast<std::int32_t>(m.detections.original(static_cast<std::size_t>(k)));
  return detection_of;
}

FrameMatch link_without_lookahead(const LinkOptions& options, const Tracks& tracks, const FrameAhead& frame) {
  FrameMatch m(options, tracks, frame.detections, frame.time, frame.tracers);
  predict(m);
  link_without_rivals(m);
  const auto n = static_cast<double>(m.tracks.size());
  const bool rough = n - static_cast<double>(m.report.settled) > kLinkCosts.open_fraction * n;
  follow_neighbours(m);
  assign_open_tracks(m);
  // If all beads are present, a single ambiguous link justifies the collective matching. If some are missing,
  // nearly every frame has an ambiguous link, and it is mostly right.
  if ((m.report.ambiguous > 0 && (rough || m.is_complete())) || (rough && neighbours_separate(m)))
    match_all(m, {});
  return m;
}

/// For each detection, in the order of the grid: the step that would have led there in free flight if the
/// bead continues to the frame ahead in free flight; NaN if unknown. A copy of the tracks advances with the
/// present links.
std::vector<PixelPoint> steps_back(const FrameMatch& m, const FrameAhead& frame, const FrameAhead& ahead) {
  std::vector<PixelPoint> steps(m.detections.size(), {kNaN, kNaN});
  if (ahead.time.interval <= 0) return steps;
  Tracks advanced = m.before;
  LinkReport unused;
  update(advanced, {frame.detections, frame.time, frame.tracers, in_order_given(m)}, m.options.memory,
         unused);
  FrameMatch next = link_without_lookahead(m.options, advanced, ahead);
  link_left_over(next);
  std::vector<PixelPoint> onward(frame.detections.size(), {kNaN, kNaN});
  for (std::size_t t = 0; t < next.tracks.size(); ++t) {
    const Track& track = next.tracks[t];
    if (track.missed > 0 || next.detection_of[t] < 0) continue;
    onward[static_cast<std::size_t>(track.detection)] =
        (frame.time.interval / ahead.time.interval) * (next.detected(t) - track.place) -
        PixelPoint{0, m.options.fall_px * frame.time.interval * frame.time.interval};
  }
  for (std::size_t k = 0; k < m.detections.size(); ++k) steps[k] = onward[m.detections.original(k)];
  return steps;
}

/// Matches the frame again with the frame ahead as evidence, if beads follow ballistic paths.
void match_with_lookahead(FrameMatch& m, const FrameAhead& frame, const FrameAhead& ahead) {
  const std::vector<PixelPoint> back = steps_back(m, frame, ahead);
  if (!follows_ballistic(m, back)) return;
  const std::vector<std::int32_t> first = m.detection_of;
  match_all(m, back);
  // A link that the frame ahead has changed is ambiguous, whatever its odds are now.
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    if (m.detection_of[t] >= 0 && m.detection_of[t] != first[t])
      m.mark_ambiguous(static_cast<std::size_t>(m.detection_of[t]));
}

}  // namespace

Linker::Linker(const LinkOptions& options, int phases_per_cycle) : options_(options) {
  auto at = [](const char* key) { return Where{.file = {}, .key = key}; };
  require_range(at("link.diameter_px"), options.diameter_px, 0, std::nullopt, true);
  require_range(at("--range"), options.range_diameters, 0, 10, true);
  require_range(at("--memory"), options.memory, 0, 1000);
  require_range(at("link.max_shift_diameters"), options.max_shift_diameters, 0, 10);
  tracks_.phases = phases_per_cycle > kMaxPhases ? 0 : phases_per_cycle;
  tracks_.cycle_of_phase.assign(static_cast<std::size_t>(tracks_.phases), -2);
}

Linker Linker::reversed() const {
  Linker back = *this;
  back.tracks_ = tracks_.reversed(options_.fall_px);
  return back;
}

std::vector<std::int64_t> Linker::next(std::span<const PixelPoint> detections, const FrameTime& time,
                                       std::span<const std::uint8_t> tracers, const FrameAhead* ahead) {
  require_places(detections, tracks_.frames);
  if (ahead != nullptr) require_places(ahead->detections, tracks_.frames + 1);
  const FrameAhead frame{detections, time, tracers};
  FrameMatch m = link_without_lookahead(options_, tracks_, frame);
  if (m.report.rematched > 0 && ahead != nullptr) match_with_lookahead(m, frame, *ahead);
  link_left_over(m);
  last_ = m.report;
  ambiguous_ = m.ambiguous;
  std::vector<std::int64_t> ids =
      update(tracks_, {detections, time, tracers, in_order_given(m)}, options_.memory, last_);
  ++tracks_.frames;
  total_.add(last_);
  return ids;
}

}  // namespace twincell::imaging
