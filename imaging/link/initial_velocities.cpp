#include "imaging/link/initial_velocities.hpp"

#include <cmath>
#include <unordered_map>

#include "core/constants.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kMaxSearched = 40;  // frames searched for a calm one

FrameAhead ahead_of(const FrameOfBeads& frame, const FrameTime& time) {
  return {frame.places, time, frame.tracers};
}

/// Deviation of the tracks from free flight: sum of log(1 + r^2/u^2), where r is the difference between a
/// step and the previous step plus its fall. A track that begins counts like two differences of one diameter.
/// In simulated convecting beds the true tracks have a smaller sum than the tracks of a linker.
double roughness(const LinkOptions& options, const std::vector<FrameOfBeads>& frames,
                 const std::vector<std::vector<std::int64_t>>& tracks) {
  constexpr double kUnit = 0.02;  // diameters
  struct Last {
    std::size_t frame = 0;
    PixelPoint place, step;
    bool stepped = false;
  };
  std::unordered_map<std::int64_t, Last> lasts;
  double sum = 0;
  const double unit = kUnit * options.diameter_px;
  for (std::size_t f = 0; f < tracks.size(); ++f) {
    const double interval = frames[f].time.interval;
    for (std::size_t k = 0; k < tracks[f].size(); ++k) {
      const PixelPoint p = frames[f].places[k];
      const auto at = lasts.find(tracks[f][k]);
      const bool goes_on = at != lasts.end() && at->second.frame + 1 == f && interval > 0;
      Last now{.frame = f, .place = p, .step = {}, .stepped = goes_on};
      if (goes_on) {
        const Last& last = at->second;
        now.step = {(p.x_px - last.place.x_px) / interval, (p.y_px - last.place.y_px) / interval};
        if (last.stepped)
          sum += std::log1p((std::pow(now.step.x_px - last.step.x_px, 2) +
                             std::pow(now.step.y_px - last.step.y_px - options.fall_px, 2)) /
                            (unit * unit));
      } else if (f > 0) {
        sum += 2 * std::log1p(1 / (kUnit * kUnit));
      }
      lasts[tracks[f][k]] = now;
    }
  }
  return sum;
}

}  // namespace

std::vector<PixelPoint> initial_velocities(const LinkOptions& options, int phases_per_cycle,
                                           std::size_t frames,
                                           const std::function<FrameOfBeads(std::size_t)>& read) {
  if (frames < 3) return {};
  Linker linker(options, phases_per_cycle);
  std::vector<FrameOfBeads> seen;
  seen.push_back(read(0));
  // Forward: link on trial until a frame is calm.
  std::vector<std::vector<std::int64_t>> forward;  // track by frame and detection
  bool calm = false;
  for (std::size_t f = 0; !calm && f < frames && f <= kMaxSearched; ++f) {
    const bool more = f + 1 < frames;
    if (more) seen.push_back(read(f + 1));
    const FrameOfBeads& frame = seen[f];
    const FrameAhead ahead = more ? ahead_of(seen[f + 1], seen[f + 1].time) : FrameAhead{};
    forward.push_back(linker.next(frame.places, frame.time, frame.tracers, more ? &ahead : nullptr));
    const LinkReport& last = linker.last();
    calm = f > 0 && last.rematched == 0 && last.ambiguous == 0 && last.births == 0;
    if (calm && f == 1) return {};
  }
  seen.resize(static_cast<std::size_t>(linker.total().frames));
  const double interval = seen[1].time.interval;
  if (interval <= 0) return {};  // the first frame, taken twice
  // Backward: the time between two frames stays the same, the order of cycles is reversed.
  const auto time_back = [&](std::size_t f) {
    return FrameTime{
        .interval = seen[f + 1].time.interval, .phase = seen[f].time.phase, .cycle = -seen[f].time.cycle};
  };
  Linker back = linker.reversed();
  std::vector<std::vector<std::int64_t>> backward = forward;
  for (std::size_t f = seen.size() - 1; f-- > 0;) {
    const FrameAhead ahead = f > 0 ? ahead_of(seen[f - 1], time_back(f - 1)) : FrameAhead{};
    backward[f] = back.next(seen[f].places, time_back(f), seen[f].tracers, f > 0 ? &ahead : nullptr);
  }
  // Steps: only if the tracks found backwards are smoother than the trial tracks.
  const auto& before = backward[1];
  const auto& ids = backward[0];
  if (roughness(options, seen, backward) >= roughness(options, seen, forward)) return {};
  std::vector<PixelPoint> steps(seen[0].places.size(), {kNaN, kNaN});
  std::unordered_map<std::int64_t, PixelPoint> second;
  for (std::size_t k = 0; k < before.size(); ++k) second[before[k]] = seen[1].places[k];
  for (std::size_t k = 0; k < ids.size(); ++k)
    if (const auto to = second.find(ids[k]); to != second.end() && back.ambiguous()[k] == 0)
      steps[k] = {(to->second.x_px - seen[0].places[k].x_px) / interval,
                  (to->second.y_px - seen[0].places[k].y_px) / interval - options.fall_px * interval};
  return steps;
}

}  // namespace twincell::imaging
