#include "imaging/pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_map>
#include <utility>

#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/in_parallel.hpp"
#include "analysis/trajectory/json_text.hpp"
#include "imaging/first_steps.hpp"
#include "imaging/found_phase.hpp"
#include "imaging/settings.hpp"
#include "imaging/trigger_list.hpp"

namespace twincell {

namespace {

constexpr std::size_t kMostNamed = 1000;  // dropped or doubled frames that are listed one by one

// Each frame is a unit of work of its own, so that results do not depend on who computes them.
std::vector<Located> locate_batch(const std::vector<cv::Mat>& batch, const LocatorOptions& options,
                                  int threads) {
  std::vector<Located> results(batch.size());
  in_parallel(batch.size(), threads, [&](std::size_t i) { results[i] = locate(batch[i], options); });
  return results;
}

bool outside(const CellDescription& cell, cv::Size picture, const Detection& b) {
  if (!cell.origin || !cell.pixels_per_sigma) return false;
  const Vec3 r = cell.pixel_frame(picture).cell_from_pixel({b.x, b.y});
  return (cell.width && (r.x() < 0 || r.x() > *cell.width)) || (cell.height && r.z() > *cell.height + 0.5);
}

/// Frames that were looked at before their turn, then those that follow.
class ReadAhead {
 public:
  explicit ReadAhead(FrameSource& frames) : frames_(frames) {}
  /// The frame after so many others; none if there are fewer.
  const cv::Mat* look(std::size_t ahead) {
    while (waiting_.size() <= ahead) {
      cv::Mat frame;
      if (!frames_.next(frame)) return nullptr;
      waiting_.push_back(frame);
    }
    return &waiting_[ahead];
  }
  bool next(cv::Mat& frame) {
    if (waiting_.empty()) return frames_.next(frame);
    frame = waiting_.front();
    waiting_.pop_front();
    return true;
  }

 private:
  FrameSource& frames_;
  std::deque<cv::Mat> waiting_;
};

void take(const FoundSettings& found, LocatorOptions& options) {
  options.diameter_px = found.diameter_px;
  options.preprocess.bright = found.bright;
  if (options.other_diameters_px.empty()) options.other_diameters_px = found.other_diameters_px;
  if (!found.method.empty()) options.refine.method = found.method;
  options.preprocess.contrast = found.contrast;
  options.polarity_known = true;
}

/// Finds what the options leave open from the first frame that shows a bead then, of those looked at; more
/// and more are passed over, for each look takes as long as locating many. \returns its number
std::int64_t settle(ReadAhead& frames, const FrameSource& source, LocatorOptions& options) {
  constexpr std::size_t kLast = 32;
  std::optional<LocatorOptions> first;  // found where no bead was seen
  for (std::size_t k = 0; k <= kLast; k = std::max<std::size_t>(2 * k, k + 1)) {
    const cv::Mat* frame = frames.look(k);
    if (frame == nullptr) break;
    const auto found = find_settings(*frame, options);
    if (!found) continue;
    LocatorOptions settled = options;
    take(*found, settled);
    if (settled.refine.method == "edges") settled.preprocess.contrast = find_contrast(*frame, settled);
    if (!first) first = settled;
    if (locate(*frame, settled).beads.empty()) continue;
    options = settled;
    return static_cast<std::int64_t>(k);
  }
  if (!first && options.diameter_px <= 0)
    throw InputError(
        Where{.file = source.current(), .key = {}},
        "shows no discs from which a bead diameter could be estimated; give it with --diameter.");
  if (first) options = *first;
  options.polarity_known = true;
  return 0;
}

}  // namespace

LocatedStack locate_stack(FrameSource& source, LocatorOptions& options, int threads, const LocatedSink& sink,
                          Progress& progress) {
  cv::setNumThreads(1);  // one pool only: ours
  ReadAhead frames(source);
  LocatedStack stack;
  if (const cv::Mat* first = frames.look(0)) {
    if (options.diameter_px <= 0 || !options.polarity_known)
      stack.settings_frame = settle(frames, source, options);
    else
      options.preprocess.contrast = find_contrast(*first, options);
  }
  const std::size_t batch_size = 2 * static_cast<std::size_t>(std::max(threads, 1));
  for (bool more = true; more;) {
    std::vector<cv::Mat> batch;
    for (cv::Mat frame; batch.size() < batch_size && (more = frames.next(frame)); frame = cv::Mat())
      batch.push_back(frame);
    if (batch.empty()) break;
    const std::vector<Located> results = locate_batch(batch, options, threads);
    for (std::size_t i = 0; i < batch.size(); ++i) sink(stack.frames++, batch[i], results[i]);
    progress.update(stack.frames, static_cast<std::int64_t>(source.announced()));
  }
  if (stack.frames == 0) throw InputError(Where{.file = source.current(), .key = {}}, "holds no frame.");
  return stack;
}

namespace {

PixelPoint place_of(const TrackedBead& b) {
  return {b.x_px, b.y_px};
}

// The bed's motion without knowing phases: steps common to all beads, added up, and whether there were any.
BedMotion bed_motion(const BeadSpool& located, const LinkOptions& link, double unit_px) {
  Linker linker(link);
  BedMotion motion;
  std::vector<PixelPoint> places;
  std::vector<std::uint8_t> tracers;
  std::unordered_map<std::int64_t, TrackedBead> before, now;
  std::vector<double> steps;
  double height = 0;
  for (std::size_t f = 0; f < located.size(); ++f) {
    const std::vector<TrackedBead> beads = located[f];
    places.clear();
    tracers.clear();
    for (const TrackedBead& b : beads) {
      places.push_back(place_of(b));
      tracers.push_back(b.tracer ? 1 : 0);
    }
    const std::vector<std::int64_t> ids = linker.next(places, {}, tracers);
    now.clear();
    steps.clear();
    for (std::size_t k = 0; k < beads.size(); ++k) {
      const TrackedBead& b = now[ids[k]] = beads[k];
      const auto old = before.find(ids[k]);
      if (old == before.end()) continue;
      const TrackedBead& a = old->second;
      steps.push_back(std::hypot((b.x_px - a.x_px) / std::hypot(a.sigma_x_px, b.sigma_x_px),
                                 (b.y_px - a.y_px) / std::hypot(a.sigma_y_px, b.sigma_y_px)));
    }
    std::swap(before, now);
    height -= f > 0 ? linker.mean_step().y_px / unit_px : 0;
    motion.heights.push_back(height);
    motion.repeats.push_back(log_odds_of_repeat(steps));
  }
  return motion;
}

PhaseTable learn_phases(const BeadSpool& located, const LinkOptions& link, const CellDescription& cell,
                        const PhaseWay& way) {
  if (way.triggers) {
    PhaseTable table = read_triggers(*way.triggers, way.drive_hz, cell.phase_lock.frames_per_cycle);
    if (table.frames.size() != located.size())
      throw InputError(Where{.file = way.triggers->string(), .key = {}},
                       "has " + std::to_string(table.frames.size()) + " lines for " +
                           std::to_string(located.size()) +
                           " frames; every frame of the stack needs its line.");
    return table;
  }
  if (!way.find) return fixed_phases(cell.phase_lock);
  FoundPhaseOptions options{
      .frames_per_cycle = cell.phase_lock.frames_per_cycle, .gamma = {}, .amplitude = {}};
  if (const auto drive = cell.drive()) options.gamma = drive->gamma();
  return find_phases(bed_motion(located, link, cell.pixels_per_sigma.value_or(link.diameter_px)), options);
}

}  // namespace

std::vector<std::int64_t> TrackedStack::broken_tracers() const {
  std::vector<std::int64_t> broken;
  const auto end = static_cast<std::int64_t>(frames.size()) - 1;
  for (std::size_t t = 0; t < tracks.size(); ++t)
    if (tracks[t].is_tracer() && (tracks[t].first > 0 || tracks[t].last < end))
      broken.push_back(static_cast<std::int64_t>(t));
  return broken;
}

TrackedStack link_spool(const BeadSpool& located, LinkOptions link, const CellDescription& cell,
                        const PhaseWay& way, const std::filesystem::path& spool_folder, Progress& progress) {
  TrackedStack stack{.frames = BeadSpool(spool_folder), .tracks = {}, .phases = {}, .links = {}};
  stack.phases = learn_phases(located, link, cell, way);
  if (const auto drive = cell.drive(); drive && stack.phases.locked() && cell.pixels_per_sigma) {
    const double dt = drive->period() / stack.phases.frames_per_cycle;
    link.fall_px = dt * dt * *cell.pixels_per_sigma;
  }
  Linker linker(link, stack.phases.frames_per_cycle);
  // A frame and the one after it, by which its links are judged too.
  struct Seen : FrameOfBeads {
    std::vector<TrackedBead> beads;
  };
  auto read = [&](std::size_t f) {
    Seen frame;
    if (f >= located.size()) return frame;
    frame.beads = located[f];
    for (const TrackedBead& b : frame.beads) {
      frame.places.push_back(place_of(b));
      frame.tracers.push_back(b.tracer ? 1 : 0);
    }
    const FramePhase at = stack.phases.at(static_cast<std::int64_t>(f));
    frame.moment = {.interval = at.interval, .phase = at.phase, .cycle = at.cycle};
    return frame;
  };
  linker.begin(first_steps(link, stack.phases.frames_per_cycle, located.size(), read));
  Seen next = read(0);
  for (std::size_t f = 0; f < located.size(); ++f) {
    Seen frame = std::exchange(next, read(f + 1));
    std::vector<TrackedBead>& beads = frame.beads;
    const FrameAhead ahead{next.places, next.moment, next.tracers};
    const std::vector<std::int64_t> ids =
        linker.next(frame.places, frame.moment, frame.tracers, f + 1 < located.size() ? &ahead : nullptr);
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
    }
    stack.frames.append(beads);
    if (f % 64 == 0) progress.update(static_cast<std::int64_t>(f), static_cast<std::int64_t>(located.size()));
  }
  stack.n_tracks = linker.n_tracks();
  stack.links = linker.total();
  return stack;
}

TrackedStack track_stack(FrameSource& frames, LocatorOptions& locator, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress, const PhaseWay& way,
                         const std::filesystem::path& spool_folder) {
  // A list that cannot be read is refused before the work, not after.
  if (way.triggers) (void)read_triggers(*way.triggers, way.drive_hz, cell.phase_lock.frames_per_cycle);
  BeadSpool located(spool_folder);
  int width = 0, height = 0;
  std::size_t outside_cell = 0, wrong_radius = 0;
  link.closed = cell.sides == Boundary::wall;
  std::vector<TrackedBead> beads;
  locate_stack(
      frames, locator, threads,
      [&](std::int64_t, const cv::Mat& grey, const Located& found) {
        width = grey.cols;
        height = grey.rows;
        beads.clear();
        wrong_radius += static_cast<std::size_t>(
            std::count_if(found.dropped.begin(), found.dropped.end(),
                          [](const Detection& b) { return b.verdict == Verdict::wrong_radius; }));
        for (const Detection& b : found.beads) {
          if (outside(cell, grey.size(), b)) {
            ++outside_cell;
            continue;
          }
          if (b.edge) link.closed = false;  // where one is cut by the frame, others come and go
          beads.push_back({.x_px = b.x,
                           .y_px = b.y,
                           .radius_px = b.radius,
                           .tracer = b.tracer,
                           .sigma_x_px = b.sigma_x,
                           .sigma_y_px = b.sigma_y});
        }
        located.append(beads);
      },
      progress);
  // No two beads are nearer to each other than the smallest are.
  link.diameter_px = locator.diameter_px;
  for (const double other : locator.other_diameters_px) link.diameter_px = std::min(link.diameter_px, other);
  TrackedStack stack = link_spool(located, link, cell, way, spool_folder);
  stack.width_px = width;
  stack.height_px = height;
  stack.outside_cell = outside_cell;
  stack.wrong_radius = wrong_radius;
  return stack;
}

TrackPlan plan_trajectory(const TrackedStack& stack, const CellDescription& cell, double diameter_px,
                          int shortest) {
  TrackPlan plan;
  const double scale = cell.pixels_per_sigma.value_or(diameter_px);
  plan.pixel_frame = cell.pixel_frame({stack.width_px, stack.height_px}, scale,
                                      cell.origin.value_or(PixelPoint{-0.5, stack.height_px - 0.5}));
  TrajectoryInfo& info = plan.info;
  plan.slot_of_track.assign(stack.tracks.size(), -1);
  for (std::size_t t = 0; t < stack.tracks.size(); ++t) {
    const TrackSummary& track = stack.tracks[t];
    if (track.seen < shortest) continue;
    plan.slot_of_track[t] = static_cast<std::int64_t>(info.n_beads++);
    info.radius.push_back(track.radius_px / scale);
    info.tracer.push_back(track.is_tracer() ? 1 : 0);
  }
  info.drive = cell.drive();
  info.columns.identity = true;
  info.columns.position_sigma = true;
  info.columns.phase = stack.phases.locked();
  info.columns.plate_height = info.drive && stack.phases.locked();
  info.phases_per_cycle = stack.phases.frames_per_cycle;
  info.box.lower = Vec3(0, -0.5, 0);
  info.box.upper =
      Vec3(cell.width.value_or(stack.width_px / scale), 0.5, cell.height.value_or(stack.height_px / scale));
  info.box.boundary = {cell.width ? cell.sides : Boundary::open, Boundary::open,
                       cell.origin ? Boundary::wall : Boundary::open};
  if (info.box.boundary[0] == Boundary::wall && cell.side_tilt) info.box.side_tilt = *cell.side_tilt;
  info.scale = cell.scale;
  info.scale.pixels_per_sigma = scale;
  info.source = "experiment";
  info.tracking_json = tracking_json(stack, plan, cell);
  return plan;
}

std::string tracking_json(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell) {
  const PhaseTable& phases = stack.phases;
  nlohmann::json lock = {{"way", phases.way}};
  if (phases.locked()) lock["frames_per_cycle"] = phases.frames_per_cycle;
  if (phases.locked()) lock["first_phase"] = phases.first_phase;
  if (phases.period_frames) lock["period_frames"] = *phases.period_frames;
  if (phases.jitter) lock["jitter_frames"] = *phases.jitter;
  if (phases.agreement) lock["agreement"] = *phases.agreement;
  if (!phases.frames.empty()) {
    lock["dropped"] = phases.dropped;
    lock["doubled"] = phases.doubled;
    for (std::size_t f = 1; f < phases.frames.size(); ++f) {
      const double interval = phases.frames[f].interval;
      if (interval > 1 && lock["dropped_before"].size() < kMostNamed) lock["dropped_before"].push_back(f);
      if (interval == 0 && lock["doubled_frames"].size() < kMostNamed) lock["doubled_frames"].push_back(f);
    }
  }
  const LinkReport& l = stack.links;
  nlohmann::json tracers = {
      {"count", 0}, {"broken", nlohmann::json::array()}, {"uncertain", nlohmann::json::array()}};
  std::int64_t count = 0;
  for (std::size_t t = 0; t < stack.tracks.size(); ++t)
    if (stack.tracks[t].is_tracer() && plan.slot_of_track[t] >= 0) {
      ++count;
      if (const std::int64_t links = stack.tracks[t].ambiguous; links > 0)
        tracers["uncertain"].push_back({{"slot", plan.slot_of_track[t]}, {"ambiguous", links}});
    }
  tracers["count"] = count;
  for (const std::int64_t t : stack.broken_tracers())
    if (const std::int64_t slot = plan.slot_of_track[static_cast<std::size_t>(t)]; slot >= 0)
      tracers["broken"].push_back({{"slot", slot},
                                   {"first", stack.tracks[static_cast<std::size_t>(t)].first},
                                   {"last", stack.tracks[static_cast<std::size_t>(t)].last}});
  if (cell.phase_lock.offset != 0) lock["offset_frames"] = cell.phase_lock.offset;
  nlohmann::json document = {{"phase_lock", lock},
                             {"links",
                              {{"made", l.links},
                               {"settled", l.settled},
                               {"bridged", l.bridged},
                               {"ambiguous", l.ambiguous},
                               {"births", l.births},
                               {"losses", l.losses},
                               {"networks", l.networks},
                               {"largest_network", l.largest_network},
                               {"unsolved", l.unsolved},
                               {"rematched", l.rematched},
                               {"unclear_shifts", l.unclear_shifts}}},
                             {"tracers", tracers},
                             {"camera",
                              {{"pixels_per_sigma", plan.pixel_frame.pixels_per_sigma},
                               {"origin_px", {plan.pixel_frame.origin.x_px, plan.pixel_frame.origin.y_px}},
                               {"width_px", stack.width_px},
                               {"height_px", stack.height_px},
                               {"bright", cell.bright}}}};
  if (plan.pixel_frame.lens) {
    document["camera"]["rotation_deg"] = cell.rotation_deg;
    document["camera"]["distortion"] = cell.distortion;
  }
  if (cell.included.camera)
    document["camera"]["covariance"] = {{"names", cell.included.camera->names},
                                        {"matrix", cell.included.camera->matrix}};
  return json_text(document);
}

void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell,
                      TrajectorySink& sink) {
  const TrajectoryInfo& info = plan.info;
  const double nan = std::numeric_limits<double>::quiet_NaN(), scale = plan.pixel_frame.pixels_per_sigma;
  Frame frame;
  for (std::size_t f = 0; f < stack.frames.size(); ++f) {
    const auto number = static_cast<std::int64_t>(f);
    const FramePhase at = stack.phases.at(number);
    if (f > 0 && at.interval == 0) continue;
    frame.step = number;
    frame.phase = at.phase;
    frame.cycle = at.cycle;
    frame.time = static_cast<double>(f);
    if (info.drive && stack.phases.locked()) {
      const double fraction = (at.phase + cell.phase_lock.offset) / stack.phases.frames_per_cycle;
      frame.time = (static_cast<double>(at.cycle) + fraction) * info.drive->period();
      frame.plate_height = info.drive->displacement(fraction - std::floor(fraction));
    }
    frame.position.assign(info.n_beads, Vec3(nan, nan, nan));
    frame.position_sigma.assign(info.n_beads, Vec3(nan, nan, nan));
    frame.id.assign(info.n_beads, -1);
    for (const TrackedBead& b : stack.frames[f]) {
      const std::int64_t slot = plan.slot_of_track[static_cast<std::size_t>(b.track)];
      if (slot < 0) continue;
      const auto i = static_cast<std::size_t>(slot);
      frame.id[i] = slot;
      frame.position[i] = plan.pixel_frame.cell_from_pixel({b.x_px, b.y_px});
      frame.position_sigma[i] = Vec3(b.sigma_x_px / scale, nan, b.sigma_y_px / scale);
    }
    sink.append(frame);
  }
}

}  // namespace twincell
