#include "imaging/track/write_trajectory.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "imaging/track/beneath_plate.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kMaxNamed = 1000;  // largest number of dropped or doubled frames listed individually

}  // namespace

TrackPlan plan_trajectory(const TrackedStack& stack, const CellDescription& cell, double diameter_px,
                          int shortest) {
  TrackPlan plan;
  const double scale = cell.pixels_per_sigma.value_or(diameter_px);
  plan.pixel_frame = cell.pixel_frame({stack.width_px, stack.height_px}, scale,
                                      cell.origin.value_or(PixelPoint{-0.5, stack.height_px - 0.5}));
  const std::vector<char> in_plate = beneath_plate(stack, cell, plan.pixel_frame);
  TrajectoryInfo& info = plan.info;
  plan.slot_of_track.assign(stack.tracks.size(), -1);
  for (std::size_t t = 0; t < stack.tracks.size(); ++t) {
    const TrackSummary& track = stack.tracks[t];
    if (track.seen < shortest) continue;
    if (in_plate[t] != 0) {
      ++plan.in_plate;
      continue;
    }
    plan.slot_of_track[t] = static_cast<std::int64_t>(info.n_beads++);
    info.radius.push_back(track.radius_px / cell.disc_width_px.value_or(scale));
    info.tracer.push_back(track.is_tracer() ? 1 : 0);
  }
  info.drive = cell.drive();
  info.columns.identity = true;
  info.columns.position_sigma = stack.has_errors;
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
  info.source = Origin::experiment;
  info.tracking_json = json_text(tracking_report(stack, plan, cell));
  return plan;
}

std::string TrackPlan::in_plate_note() const {
  if (in_plate == 0) return {};
  return fmt::format("{} inside the plate {} left out: marks, text or false discs, not beads.",
                     plural(in_plate, "track"), in_plate == 1 ? "is" : "are");
}

nlohmann::json tracking_report(const TrackedStack& stack, const TrackPlan& plan,
                               const CellDescription& cell) {
  // Phases: only the measured quantities are present.
  const PhaseTable& phases = stack.phases;
  nlohmann::json lock = {{"method", row_of(kPhaseMethods, phases.method).word}};
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
      if (interval > 1 && lock["dropped_before"].size() < kMaxNamed) lock["dropped_before"].push_back(f);
      if (interval == 0 && lock["doubled_frames"].size() < kMaxNamed) lock["doubled_frames"].push_back(f);
    }
  }
  if (!phases.out_of_lock.empty()) {
    lock["out_of_lock"] = frames_in(phases.out_of_lock);
    for (const FrameStretch& s : phases.out_of_lock)
      if (lock["out_of_lock_frames"].size() < kMaxNamed)
        lock["out_of_lock_frames"].push_back({s.first, s.last});
  }
  if (phases.between > 0) lock["between_phases"] = phases.between;
  // Tracers: tracks too short for a slot are omitted.
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
  if (phases.offset != 0) lock["offset_frames"] = phases.offset;
  if (!phases.checked_by.empty()) lock["checked_by"] = phases.checked_by;
  if (!phases.not_checked.empty()) lock["not_checked"] = phases.not_checked;
  if (!phases.warning.empty()) lock["warning"] = phases.warning;
  // Document: the camera is the map by which pixels became lengths.
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
  if (cell.scale_error_px) document["camera"]["scale_error_px"] = *cell.scale_error_px;
  if (plan.pixel_frame.lens) {
    document["camera"]["rotation_deg"] = cell.rotation_deg;
    document["camera"]["distortion"] = cell.distortion;
  }
  if (cell.included.camera)
    document["camera"]["covariance"] = {{"names", cell.included.camera->names},
                                        {"matrix", cell.included.camera->matrix}};
  return document;
}

void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, TrajectorySink& sink) {
  const TrajectoryInfo& info = plan.info;
  const double nan = std::numeric_limits<double>::quiet_NaN(), scale = plan.pixel_frame.pixels_per_sigma;
  Frame frame;
  for (std::size_t f = 0; f < stack.frames.size(); ++f) {
    const auto number = static_cast<std::int64_t>(f);
    const FramePhase at = stack.phases.at(number);
    if (!stack.phases.is_used(number)) continue;
    frame.step = stack.range.number(number);
    frame.phase = at.phase;
    frame.cycle = at.cycle;
    frame.time = static_cast<double>(f);
    if (const auto cycles = stack.phases.cycles_at(number); info.drive && cycles) {
      frame.time = *cycles * info.drive->period();
      frame.plate_height = info.drive->displacement(*cycles - std::floor(*cycles));
    }
    frame.position.assign(info.n_beads, Vec3(nan, nan, nan));
    if (stack.has_errors) frame.position_sigma.assign(info.n_beads, Vec3(nan, nan, nan));
    frame.id.assign(info.n_beads, -1);
    for (const TrackedBead& b : stack.frames[f]) {
      const std::int64_t slot = plan.slot_of_track[static_cast<std::size_t>(b.track)];
      if (slot < 0) continue;
      const auto i = static_cast<std::size_t>(slot);
      frame.id[i] = slot;
      frame.position[i] = plan.pixel_frame.cell_from_pixel({b.x_px, b.y_px});
      if (stack.has_errors) frame.position_sigma[i] = Vec3(b.sigma_x_px / scale, nan, b.sigma_y_px / scale);
    }
    sink.append(frame);
  }
}

}  // namespace twincell::imaging
