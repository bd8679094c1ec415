#include "imaging/link/tracks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/constants.hpp"
#include "imaging/link/link_costs.hpp"
#include "imaging/link/point_grid.hpp"

namespace twincell::imaging {

namespace {

/// Phase of a frame in the cycle, and whether it has one.
struct CyclePhase {
  bool known;
  std::size_t index;
};

CyclePhase phase_of(const Tracks& tracks, const FrameTime& time) {
  const bool known = tracks.phases > 0 && time.phase >= 0 && time.phase < tracks.phases;
  return {known, static_cast<std::size_t>(known ? time.phase : 0)};
}

/// Steps of the beads that were linked from the last frame; before the second frame, the known first steps.
std::vector<PixelPoint> steps_of_linked(const Tracks& tracks, const FrameLinks& links) {
  std::vector<PixelPoint> steps;
  for (std::size_t t = 0; t < tracks.active.size(); ++t)
    if (links.detection_of[t] >= 0 && tracks.active[t].missed == 0)
      steps.push_back(links.detections[static_cast<std::size_t>(links.detection_of[t])] -
                      tracks.active[t].place);
  if (tracks.frames == 0)
    std::copy_if(tracks.first_steps.begin(), tracks.first_steps.end(), std::back_inserter(steps),
                 [](PixelPoint step) { return std::isfinite(step.x_px); });
  return steps;
}

/// Sets the common steps. Returns the median step in this frame.
PixelPoint update_common_step(Tracks& tracks, const FrameLinks& links) {
  std::vector<PixelPoint> steps = steps_of_linked(tracks, links);
  tracks.mean_step = {};
  for (const PixelPoint step : steps) tracks.mean_step = tracks.mean_step + step;
  if (!steps.empty()) tracks.mean_step = (1.0 / static_cast<double>(steps.size())) * tracks.mean_step;
  const std::size_t stride = std::max<std::size_t>(1, steps.size() / (2 * kLinkCosts.sample_tracks));
  for (std::size_t i = 1; i * stride < steps.size(); ++i) steps[i] = steps[i * stride];
  steps.resize((steps.size() + stride - 1) / stride);
  const PixelPoint moved = median(steps);
  const double interval = links.time.interval;
  if (tracks.frames == 0)
    tracks.step = moved;  // first steps are per interval
  else if (interval > 0)
    tracks.step = 1 / interval * moved;
  return moved;
}

/// Moves the linked tracks to their detections and the missing ones by the common step.
/// \param ids set to the numbers of the linked tracks
void move_tracks(Tracks& tracks, const FrameLinks& links, PixelPoint moved, std::vector<std::int64_t>& ids,
                 LinkReport& report) {
  const auto phases = static_cast<std::size_t>(tracks.phases);
  const CyclePhase phase = phase_of(tracks, links.time);
  const bool remembers = phase.known && tracks.cycle_of_phase[phase.index] == links.time.cycle - 1;
  const double interval = links.time.interval, per_interval = interval > 0 ? 1 / interval : 0;
  for (std::size_t t = 0; t < tracks.active.size(); ++t) {
    Track& track = tracks.active[t];
    PixelPoint* ring = phases > 0 ? &tracks.cycle_places[t * phases] : nullptr;
    if (links.detection_of[t] < 0) {
      ++track.missed;
      track.place = track.place + moved;
      if (phase.known) ring[phase.index] = {kNaN, kNaN};
      continue;
    }
    const auto k = static_cast<std::size_t>(links.detection_of[t]);
    const PixelPoint p = links.detections[k];
    ids[k] = track.id;
    ++report.links;
    report.bridged += track.missed > 0 ? 1 : 0;
    if (track.missed > 0)
      track.step = (1.0 / (track.missed + 1)) * (p - track.place - moved) + tracks.step;
    else if (interval > 0)
      track.step = per_interval * (p - track.place);
    track.place = p;
    track.missed = 0;
    ++track.seen;
    track.detection = static_cast<std::int32_t>(k);
    if (!links.tracers.empty()) track.tracer = links.tracers[k];
    if (phase.known) {
      const PixelPoint drift = p - ring[phase.index];
      track.drift = remembers && std::isfinite(drift.x_px) ? drift : PixelPoint{};
      ring[phase.index] = p;
    }
  }
}

/// Ends tracks that have been missing too long. The last track takes the slot of a track that ends.
void end_lost_tracks(Tracks& tracks, int memory, LinkReport& report) {
  const auto phases = static_cast<std::size_t>(tracks.phases);
  for (std::size_t t = 0; t < tracks.active.size();) {
    if (tracks.active[t].missed <= memory) {
      ++t;
      continue;
    }
    ++report.losses;
    const std::size_t end = tracks.active.size() - 1;
    if (t != end) {
      tracks.active[t] = tracks.active[end];
      std::copy_n(tracks.cycle_places.begin() + static_cast<std::ptrdiff_t>(end * phases), phases,
                  tracks.cycle_places.begin() + static_cast<std::ptrdiff_t>(t * phases));
    }
    tracks.active.pop_back();
    tracks.cycle_places.resize(tracks.active.size() * phases);
  }
}

/// Begins a track for each detection without one, and numbers it.
void begin_tracks(Tracks& tracks, const FrameLinks& links, std::vector<std::int64_t>& ids,
                  LinkReport& report) {
  const auto phases = static_cast<std::size_t>(tracks.phases);
  const CyclePhase phase = phase_of(tracks, links.time);
  const std::vector<PixelPoint>& first_steps = tracks.first_steps;
  for (std::size_t k = 0; k < links.detections.size(); ++k) {
    if (ids[k] >= 0) continue;
    ids[k] = tracks.numbered++;
    ++report.births;
    const bool known = k < first_steps.size() && std::isfinite(first_steps[k].x_px);
    tracks.active.push_back({.id = ids[k],
                             .place = links.detections[k],
                             .step = known ? first_steps[k] : tracks.step,
                             .drift = {},
                             .missed = 0,
                             .detection = static_cast<std::int32_t>(k),
                             .tracer = links.tracers.empty() ? std::uint8_t{0} : links.tracers[k]});
    tracks.cycle_places.resize(tracks.active.size() * phases, {kNaN, kNaN});
    if (phase.known)
      tracks.cycle_places[(tracks.active.size() - 1) * phases + phase.index] = links.detections[k];
  }
}

}  // namespace

bool Tracks::remember(const FrameTime& time) const {
  return time.phase >= 0 && time.phase < phases && time.cycle > 0 &&
         cycle_of_phase[static_cast<std::size_t>(time.phase)] == time.cycle - 1;
}

PixelPoint Tracks::predict(std::size_t t, PredictionRule rule, const FrameTime& time) const {
  const Track& track = active[t];
  switch (rule) {
    case PredictionRule::still:
      break;
    case PredictionRule::step:
      return track.place + time.interval * track.step;
    case PredictionRule::cycle: {
      const PixelPoint p =
          cycle_places[t * static_cast<std::size_t>(phases) + static_cast<std::size_t>(time.phase)];
      const PixelPoint there = p + track.drift;
      if (std::isfinite(there.x_px)) return there;
      return track.place + time.interval * track.step;
    }
  }
  return track.place;
}

PixelPoint Tracks::in_flight(std::size_t t, double fall_px, const FrameTime& time) const {
  return active[t].place + time.interval * active[t].step +
         PixelPoint{0, fall_px * time.interval * time.interval};
}

// In reversed time the next step of free flight is the negative of the last step plus the fall.
Tracks Tracks::reversed(double fall_px) const {
  Tracks back = *this;
  const PixelPoint fall{0, fall_px};
  for (Track& track : back.active) {
    track.step = -1.0 * (track.step + fall);
    track.drift = {};
  }
  back.step = -1.0 * (step + fall);
  back.mean_step = -1.0 * (mean_step + fall);
  std::fill(back.cycle_of_phase.begin(), back.cycle_of_phase.end(), std::numeric_limits<std::int64_t>::min());
  std::fill(back.cycle_places.begin(), back.cycle_places.end(), PixelPoint{kNaN, kNaN});
  return back;
}

std::vector<PixelPoint> places_of(const std::vector<Track>& tracks) {
  std::vector<PixelPoint> places;
  for (const Track& t : tracks) places.push_back(t.place);
  return places;
}

std::vector<std::int64_t> update(Tracks& tracks, const FrameLinks& links, int memory, LinkReport& report) {
  std::vector<std::int64_t> ids(links.detections.size(), -1);
  const PixelPoint moved = update_common_step(tracks, links);
  move_tracks(tracks, links, moved, ids, report);
  end_lost_tracks(tracks, memory, report);
  begin_tracks(tracks, links, ids, report);
  for (const PixelPoint p : links.detections) {
    tracks.low = {std::min(tracks.low.x_px, p.x_px), std::min(tracks.low.y_px, p.y_px)};
    tracks.high = {std::max(tracks.high.x_px, p.x_px), std::max(tracks.high.y_px, p.y_px)};
  }
  const CyclePhase phase = phase_of(tracks, links.time);
  if (phase.known) tracks.cycle_of_phase[phase.index] = links.time.cycle;
  tracks.first_steps.clear();
  return ids;
}

}  // namespace twincell::imaging
