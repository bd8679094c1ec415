#include "imaging/track/link_detections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/link/initial_velocities.hpp"
#include "imaging/phase/phase_estimation.hpp"
#include "imaging/phase/phases_of_repeated_frames.hpp"
#include "imaging/phase/plate_phases.hpp"
#include "imaging/phase/trigger_list.hpp"
#include "imaging/stack/repeated_frames.hpp"

namespace twincell::imaging {

namespace {

PixelPoint place_of(const TrackedBead& b) {
  return {b.x_px, b.y_px};
}

/// Motion of the bed, from the linked frames: the sum of the mean steps, and the log-odds that a frame
/// repeats the previous one.
class MotionOfBed {
 public:
  explicit MotionOfBed(double unit_px) : unit_px_(unit_px) {}
  /// \param ids tracks of the beads \param step mean step of the linked beads
  void add(std::span<const TrackedBead> beads, std::span<const std::int64_t> ids, PixelPoint step) {
    now_.clear();
    steps_.clear();
    for (std::size_t k = 0; k < beads.size(); ++k) {
      const TrackedBead& b = now_[ids[k]] = beads[k];
      const auto old = before_.find(ids[k]);
      if (old == before_.end()) continue;
      const TrackedBead& a = old->second;
      steps_.push_back(std::hypot((b.x_px - a.x_px) / std::hypot(a.sigma_x_px, b.sigma_x_px),
                                  (b.y_px - a.y_px) / std::hypot(a.sigma_y_px, b.sigma_y_px)));
    }
    std::swap(before_, now_);
    height_ -= motion_.heights.empty() ? 0 : step.y_px / unit_px_;
    motion_.heights.push_back(height_);
    motion_.repeats.push_back(log_odds_of_repeat(steps_));
  }
  [[nodiscard]] const BedMotion& motion() const { return motion_; }

 private:
  double unit_px_, height_ = 0;
  BedMotion motion_;
  std::unordered_map<std::int64_t, TrackedBead> before_, now_;
  std::vector<double> steps_;
};

bool is_repeat(std::span<const std::uint8_t> repeats, std::size_t frame) {
  return frame < repeats.size() && repeats[frame] != 0;
}

// Motion of the bed without known phases, of the frames that repeat no other.
BedMotion bed_motion(const DetectionStore& located, const LinkOptions& link, double unit_px,
                     std::span<const std::uint8_t> repeats) {
  Linker linker(link);
  MotionOfBed motion(unit_px);
  std::vector<PixelPoint> places;
  std::vector<std::uint8_t> tracers;
  for (std::size_t f = 0; f < located.size(); ++f) {
    if (is_repeat(repeats, f)) continue;
    const std::vector<TrackedBead> beads = located[f];
    places.clear();
    tracers.clear();
    for (const TrackedBead& b : beads) {
      places.push_back(place_of(b));
      tracers.push_back(b.tracer ? 1 : 0);
    }
    const std::vector<std::int64_t> ids = linker.next(places, {}, tracers);
    motion.add(beads, ids, linker.mean_step());
  }
  return motion.motion();
}

double unit_of(const CellDescription& cell, const LinkOptions& link) {
  return cell.pixels_per_sigma.value_or(link.diameter_px);
}

/// \param evidence of the frames that repeat no other; so are the phases, unless a list gives them
/// \param repeats [frames of the film]
PhaseTable determine_phases(const DetectionStore& located, const LinkOptions& link,
                            const CellDescription& cell, const PhaseSource& source,
                            const LockEvidence& evidence, std::span<const std::uint8_t> repeats) {
  switch (source.method) {
    case PhaseMethod::none:
      return fixed_phases({});
    case PhaseMethod::fixed:
      if (cell.phase_lock.locked() && !source.trusted) return check_lock(cell.phase_lock, evidence);
      return fixed_phases(cell.phase_lock);
    case PhaseMethod::found: {
      PhaseEstimationOptions options{.frames_per_cycle = cell.phase_lock.frames_per_cycle, .gamma = {}};
      if (const auto drive = cell.drive()) options.gamma = drive->gamma();
      if (std::optional<PhaseTable> seen =
              phases_from_plate(evidence.plate_px, options.frames_per_cycle, cell.phase_lock.offset))
        return *std::move(seen);
      PhaseTable table = estimate_phases(bed_motion(located, link, unit_of(cell, link), repeats), options);
      table.offset = cell.phase_lock.offset;
      return table;
    }
    case PhaseMethod::triggers:
      break;
  }
  PhaseTable table = read_triggers(source.triggers, source.drive_hz, cell.phase_lock.frames_per_cycle);
  if (table.frames.size() != located.size())
    throw InputError(Where{.file = source.triggers.string(), .key = {}},
                     "has " + std::to_string(table.frames.size()) + " lines for " +
                         std::to_string(located.size()) +
                         " frames; every frame of the stack needs its line.");
  if (!source.trusted) {
    const auto drive = cell.drive();
    check_list_by_plate(table, evidence.plate_px, !drive || !drive->recorded);
  }
  return table;
}

/// Smallest and largest number of beads of a frame that shows any; 0, 0 if none does.
std::pair<std::size_t, std::size_t> fewest_and_most(const DetectionStore& frames) {
  std::size_t fewest = 0, most = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames.count(f) == 0) continue;
    fewest = fewest == 0 ? frames.count(f) : std::min(fewest, frames.count(f));
    most = std::max(most, frames.count(f));
  }
  return {fewest, most};
}

}  // namespace

std::vector<std::int64_t> LinkedDetections::broken_tracers() const {
  std::vector<std::int64_t> broken;
  const auto end = static_cast<std::int64_t>(frames.size()) - 1;
  for (std::size_t t = 0; t < tracks.size(); ++t)
    if (tracks[t].is_tracer() && (tracks[t].first > 0 || tracks[t].last < end))
      broken.push_back(static_cast<std::int64_t>(t));
  return broken;
}

std::string LinkedDetections::missing_beads() const {
  constexpr double kMinRatio = 0.95;  // of the fewest to the most beads in a frame
  const auto [fewest, most] = fewest_and_most(frames);
  if (static_cast<double>(fewest) >= kMinRatio * static_cast<double>(most)) return {};
  return fmt::format(
      "the frames hold {} to {} beads: beads leave the picture, or are not found in every frame; N_l, the "
      "results and a twin count only those that are seen",
      fewest, most);
}

std::string LinkedDetections::empty_frames() const {
  constexpr std::size_t kMaxNamed = 5;
  std::size_t empty = 0;
  std::string named;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames.count(f) > 0) continue;
    if (empty < kMaxNamed) named += fmt::format("{}{}", empty == 0 ? "" : ", ", f);
    ++empty;
  }
  if (empty == 0 || empty == frames.size()) return {};
  return fmt::format(
      "{} no bead ({}{}{}, counted from the first that was read), as a black frame does; links bridge "
      "up to --memory of them in a row",
      empty == 1 ? "one frame shows" : fmt::format("{} frames show", empty),
      empty == 1 ? "frame " : "frames ", named, empty > kMaxNamed ? ", ..." : "");
}

std::string LinkedDetections::camera_moved() const {
  return in_words(camera_jumps, frames.size());
}

std::string LinkedDetections::surplus_tracks() const {
  constexpr double kMaxTracksPerBead = 1.2;
  const std::size_t most = fewest_and_most(frames).second;
  if (static_cast<double>(n_tracks) <= kMaxTracksPerBead * static_cast<double>(most)) return {};
  return fmt::format(
      "there are {} tracks, but at most {} beads in a frame: tracks are broken, beads enter and leave, or "
      "other objects, such as digits, are taken for beads (twincell locate --overlay shows them)",
      n_tracks, most);
}

std::string LinkedDetections::still_discs() const {
  constexpr std::int64_t kMinFrames = 20;
  constexpr double kMaxStillScatter = 0.01, kMinMovingScatter = 0.1;  // bead diameters
  constexpr double kMaxStillShare = 0.1;                              // of the tracks
  constexpr std::size_t kMaxNamed = 5;
  std::vector<double> moved;
  std::vector<const TrackSummary*> still;
  for (const TrackSummary& t : tracks) {
    if (t.radius_px <= 0 || t.seen < kMinFrames || 2 * t.seen < static_cast<std::int64_t>(frames.size()))
      continue;
    moved.push_back(t.scatter_px() / (2 * t.radius_px));
    if (moved.back() < kMaxStillScatter) still.push_back(&t);
  }
  if (still.empty() ||
      static_cast<double>(still.size()) > kMaxStillShare * static_cast<double>(moved.size()) ||
      upper_median(moved) < kMinMovingScatter)
    return {};
  std::string places;
  for (std::size_t i = 0; i < std::min(still.size(), kMaxNamed); ++i)
    places += fmt::format("{}({:.1f}, {:.1f})", i == 0 ? "" : ", ", still[i]->x_px, still[i]->y_px);
  return fmt::format(
      "{} in a bed that moves, at x, y = {}{} px: a bubble, dirt or a letter, which counts as a bead here; "
      "leave the place out with --mask or --roi",
      still.size() == 1 ? "one disc stands still" : fmt::format("{} discs stand still", still.size()), places,
      still.size() > kMaxNamed ? ", ..." : "");
}

namespace {

/// The frames that are linked. Up to `memory` frames in a row without beads, as black frames are, are left
/// out: their neighbours are linked as if they had not been taken. Longer gaps end the tracks.
std::vector<std::size_t> linked_frames(const DetectionStore& located, int memory) {
  std::vector<std::size_t> linked;
  for (std::size_t f = 0; f < located.size();) {
    std::size_t end = f;
    while (end < located.size() && located.count(end) == 0) ++end;
    if (end - f > static_cast<std::size_t>(memory))
      for (std::size_t k = f; k < end; ++k) linked.push_back(k);
    if (end < located.size()) linked.push_back(end);
    f = end + 1;
  }
  return linked;
}

/// Links the frames with the phases of `stack`. \param motion collects the motion of the bed, without
/// the frames of `repeats`; null: not needed
void link_frames(const DetectionStore& located, LinkOptions link, const CellDescription& cell,
                 std::span<const std::uint8_t> repeats, LinkedDetections& stack, MotionOfBed* motion,
                 Progress& progress) {
  if (const auto drive = cell.drive(); drive && stack.phases.locked() && cell.pixels_per_sigma) {
    const double dt = drive->period() / stack.phases.frames_per_cycle;
    link.fall_px = dt * dt * *cell.pixels_per_sigma;
  }
  Linker linker(link, stack.phases.frames_per_cycle);
  // One frame is read ahead, because it is also evidence for the links of the frame before it.
  struct Seen : FrameOfBeads {
    std::vector<TrackedBead> beads;
  };
  const std::vector<std::size_t> linked = linked_frames(located, link.memory);
  auto read = [&](std::size_t k) {
    Seen frame;
    if (k >= linked.size()) return frame;
    const std::size_t f = linked[k];
    frame.beads = located[f];
    for (const TrackedBead& b : frame.beads) {
      frame.places.push_back(place_of(b));
      frame.tracers.push_back(b.tracer ? 1 : 0);
    }
    const FramePhase at = stack.phases.at(static_cast<std::int64_t>(f));
    frame.time = {.interval = at.interval, .phase = at.phase, .cycle = at.cycle};
    for (std::size_t left_out = k > 0 ? linked[k - 1] + 1 : f; left_out < f; ++left_out)
      frame.time.interval += stack.phases.at(static_cast<std::int64_t>(left_out)).interval;
    return frame;
  };
  linker.begin(initial_velocities(link, stack.phases.frames_per_cycle, linked.size(), read));
  Seen next = read(0);
  std::size_t n_linked = 0;
  for (std::size_t f = 0; f < located.size(); ++f) {
    if (n_linked == linked.size() || linked[n_linked] != f) {
      if (motion != nullptr && !is_repeat(repeats, f)) motion->add({}, {}, linker.mean_step());
      stack.frames.append({});
      continue;
    }
    Seen frame = std::exchange(next, read(++n_linked));
    std::vector<TrackedBead>& beads = frame.beads;
    const FrameAhead ahead{next.places, next.time, next.tracers};
    const std::vector<std::int64_t> ids =
        linker.next(frame.places, frame.time, frame.tracers, n_linked < linked.size() ? &ahead : nullptr);
    if (motion != nullptr && !is_repeat(repeats, f)) motion->add(beads, ids, linker.mean_step());
    stack.tracks.resize(static_cast<std::size_t>(linker.n_tracks()));
    for (std::size_t k = 0; k < beads.size(); ++k) {
      beads[k].track = ids[k];
      beads[k].ambiguous = linker.ambiguous()[k] != 0;
      TrackSummary& track = stack.tracks[static_cast<std::size_t>(ids[k])];
      if (track.seen == 0) track.first = static_cast<std::int64_t>(f);
      track.last = static_cast<std::int64_t>(f);
      ++track.seen;
      track.tracer += beads[k].tracer ? 1 : 0;
      track.ambiguous += beads[k].ambiguous ? 1 : 0;
      track.radius_px += (beads[k].radius_px - track.radius_px) / static_cast<double>(track.seen);
      const double dx = beads[k].x_px - track.x_px, dy = beads[k].y_px - track.y_px;
      track.x_px += dx / static_cast<double>(track.seen);
      track.y_px += dy / static_cast<double>(track.seen);
      track.squares_px2 += dx * (beads[k].x_px - track.x_px) + dy * (beads[k].y_px - track.y_px);
    }
    stack.frames.append(beads);
    if (f % 64 == 0) progress.update(static_cast<std::int64_t>(f), static_cast<std::int64_t>(located.size()));
  }
  stack.n_tracks = linker.n_tracks();
  stack.links = linker.total();
}

/// The jumps of a bumped camera.
std::vector<CameraJump> camera_jumps_of(const DetectionStore& located, const LinkOptions& link,
                                        std::span<const double> plate_px, int frames_per_cycle) {
  std::vector<std::optional<Deciles>> x_px;
  for (std::size_t f = 0; f < located.size(); ++f) {
    std::vector<double> of_frame;
    for (const TrackedBead& b : located[f]) of_frame.push_back(b.x_px);
    x_px.push_back(deciles_of(std::move(of_frame)));
  }
  return merged(jumps_of_beads(x_px, link.diameter_px), jump_of_plate(plate_px, frames_per_cycle));
}

/// The evidence of a camera that was not bumped: the phases are those of the plate without its jumps.
LockEvidence without_jumps(LockEvidence evidence, std::span<const CameraJump> jumps) {
  for (const CameraJump& j : jumps)
    for (std::size_t f = j.frame; f < evidence.plate_px.size(); ++f)
      evidence.plate_px[f] += j.down_px.value_or(0);
  return evidence;
}

}  // namespace

LinkedDetections link_detections(const DetectionStore& located, LinkOptions link, const CellDescription& cell,
                                 const PhaseSource& source, const std::filesystem::path& folder,
                                 Progress& progress, const LockEvidence& seen) {
  const std::vector<CameraJump> jumps =
      camera_jumps_of(located, link, seen.plate_px, cell.phase_lock.frames_per_cycle);
  const LockEvidence evidence = without_jumps(seen, jumps);
  // Where the film itself gives the phases, repeated frames would spoil them.
  const bool of_film = source.method == PhaseMethod::found ||
                       (source.method == PhaseMethod::fixed && cell.phase_lock.locked() && !source.trusted);
  const std::span<const std::uint8_t> repeats =
      of_film ? std::span<const std::uint8_t>(evidence.repeats) : std::span<const std::uint8_t>();
  const auto linked = [&](PhaseTable phases, MotionOfBed* motion) {
    LinkedDetections stack{
        .frames = DetectionStore(folder), .tracks = {}, .phases = {}, .links = {}, .camera_jumps = jumps};
    stack.phases = std::move(phases);
    link_frames(located, link, cell, repeats, stack, motion, progress);
    return stack;
  };
  try {
    PhaseTable phases = determine_phases(located, link, cell, source,
                                         of_film ? without_repeats(evidence) : evidence, repeats);
    if (!evidence.copied.empty())
      phases.warning = evidence.copied + (phases.warning.empty() ? "" : "; ") + phases.warning;
    if (phases.not_checked.empty()) {
      if (!of_film && !evidence.repeats.empty())
        phases.warning =
            repeats_in_words(evidence.repeats) + (phases.warning.empty() ? "" : "; ") + phases.warning;
      return linked(with_repeats(phases, repeats), nullptr);
    }
    MotionOfBed motion(unit_of(cell, link));
    LinkedDetections stack = linked(with_repeats(phases, repeats), &motion);
    check_lock_by_bed(phases, motion.motion());
    if (phases.frames.empty()) {
      stack.phases = with_repeats(phases, repeats);
      return stack;
    }
    return linked(with_repeats(phases, repeats), nullptr);
  } catch (const ConfigError& e) {
    // Frames that are repeated may be the reason.
    if (repeats.empty()) throw;
    throw ConfigError({}, without_full_stop(e.what()) + "; " + repeats_in_words(repeats) + ".");
  }
}

}  // namespace twincell::imaging
