#include "imaging/track/track_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.hpp"
#include "core/key_assignments.hpp"

namespace twincell::imaging {

namespace {

// The source of phases that --phase-lock selects (kPhaseMethods): one of its words, a number of frames per
// cycle, or a list of triggers.
PhaseMethod phase_method(const std::string& option) {
  if (option.empty()) return PhaseMethod::fixed;
  for (const PhaseMethodRow& row : kPhaseMethods)
    if (option == row.option && row.option == row.word) return row.value;
  if (option.ends_with(".csv")) return PhaseMethod::triggers;
  int n = 0;
  const char* end = option.data() + option.size();
  if (const auto [last, error] = std::from_chars(option.data(), end, n); error == std::errc() && last == end)
    return PhaseMethod::fixed;
  throw ConfigError(
      Where{.file = {}, .key = "--phase-lock"},
      "'" + option +
          "' is neither a number of frames per cycle, 'found', 'none', nor a list of triggers (*.csv).");
}

/// \throws ConfigError if an option and an assignment state different values of one key
void refuse_other_value(const std::vector<std::string>& assignments, const std::string& key,
                        const char* option, std::optional<double> value) {
  if (!value) return;
  for (const std::string& assignment : assignments) {
    if (assigned_key(assignment) != key) continue;
    const std::string text = assignment.substr(assignment.find('=') + 1);
    double assigned = 0;
    const std::size_t from = std::min(text.find_first_not_of(" \t"), text.size());
    const auto [last, error] = std::from_chars(text.data() + from, text.data() + text.size(), assigned);
    if (error != std::errc() || assigned != *value)
      throw ConfigError({.file = {}, .key = option},
                        fmt::format("is {:g}, and --set {} states the same; give only one of the two.",
                                    *value, assignment));
  }
}

/// \throws ConfigError if options state phases that the chosen source does not use
void refuse_unused_phases(const TrackRequest& o) {
  const PhaseMethod method = phase_method(o.phase.phase_lock);
  if (method == PhaseMethod::fixed) {
    if (o.frames_per_cycle && !o.phase.phase_lock.empty() &&
        std::stoi(o.phase.phase_lock) != *o.frames_per_cycle)
      throw ConfigError({.file = {}, .key = "--frames-per-cycle"},
                        fmt::format("is {}, but --phase-lock is {}; give only one of the two.",
                                    *o.frames_per_cycle, o.phase.phase_lock));
    return;
  }
  if (o.first_phase)
    throw ConfigError({.file = {}, .key = "--first-phase"},
                      fmt::format("is {}, but --phase-lock {} does not use it; leave one of the two out.",
                                  *o.first_phase, o.phase.phase_lock));
  if (method == PhaseMethod::none && o.frames_per_cycle.value_or(0) > 0)
    throw ConfigError({.file = {}, .key = "--frames-per-cycle"},
                      fmt::format("is {}, but --phase-lock none leaves the phases out; leave one of the two "
                                  "out.",
                                  *o.frames_per_cycle));
}

}  // namespace

StatedPhases stated_phases(const PhaseRequest& o, const CellDescription& cell, const std::string& cell_file) {
  StatedPhases stated{
      .source = {.method = phase_method(o.phase_lock), .triggers = {}, .drive_hz = o.drive_hz},
      .lock = cell.phase_lock};
  auto& [source, lock] = stated;
  const Where drive_hz{.file = {}, .key = "--drive-hz"};
  if (o.drive_hz && source.method != PhaseMethod::triggers)
    throw ConfigError(drive_hz,
                      fmt::format("is {:g}, but it is used only with a list of triggers (--phase-lock "
                                  "FILE.csv); the drive of the cell is set by drive.frequency_hz.",
                                  *o.drive_hz));
  if (source.method == PhaseMethod::none) lock = {};
  if (source.method == PhaseMethod::fixed && !o.phase_lock.empty()) {
    lock.frames_per_cycle = std::stoi(o.phase_lock);
    if (lock.first_phase >= lock.frames_per_cycle) lock.first_phase = 0;
    lock.check(Where{.file = {}, .key = "--phase-lock"});
  }
  if (source.method != PhaseMethod::triggers) return stated;
  source.triggers = o.phase_lock;
  const auto drive = cell.drive();
  const auto t0 = cell.scale.t0_s();
  if (!drive || !t0) return stated;
  constexpr double kSame = 1e-3;
  const double by_cell = drive->omega / (2 * M_PI * *t0);
  if (o.drive_hz && std::abs(*o.drive_hz / by_cell - 1) > kSame)
    throw ConfigError(drive_hz,
                      fmt::format("is {:g}, but the drive in {} is {:.6g} Hz; correct one of the two.",
                                  *o.drive_hz, cell_file, by_cell));
  if (!source.drive_hz) source.drive_hz = by_cell;
  return stated;
}

CellDescription resolve_cell(const TrackRequest& o) {
  // Options that set keys of the file are passed on as assignments. If the file states a scale, a value
  // without a unit is therefore refused here too.
  std::vector<std::string> assignments = o.assignments;
  const auto assign = [&](const char* key, std::optional<double> value) {
    if (value) assignments.push_back(fmt::format("{}={}", key, *value));
  };
  assign("cell.width", o.width);
  assign("cell.height", o.height);
  assign("drive.gamma", o.gamma);
  assign("drive.amplitude", o.amplitude);
  refuse_contradictory_assignments(assignments);
  refuse_other_value(assignments, "camera.pixels_per_sigma", "--pixels-per-sigma", o.pixels_per_sigma);
  refuse_other_value(assignments, "camera.frames_per_cycle", "--frames-per-cycle", o.frames_per_cycle);
  refuse_other_value(assignments, "camera.first_phase", "--first-phase", o.first_phase);
  if (o.origin)
    for (const std::string& assignment : assignments)
      if (assigned_key(assignment) == "camera.origin_px")
        throw ConfigError({.file = {}, .key = "--origin-px"},
                          fmt::format("and --set {} state the same; give only one of the two.", assignment));
  refuse_unused_phases(o);
  CellDescription cell = read_cell(o.cell_file, assignments);
  if (o.pixels_per_sigma) {
    cell.pixels_per_sigma = o.pixels_per_sigma;
    cell.scale_error_px.reset();  // that of the file is the error of another number
  }
  if (o.origin) cell.origin = PixelPoint{(*o.origin)[0], (*o.origin)[1]};
  if (o.frames_per_cycle) cell.phase_lock.frames_per_cycle = *o.frames_per_cycle;
  if (o.first_phase) cell.phase_lock.first_phase = *o.first_phase;
  // Two quantities determine the drive. A third quantity, from the file, would contradict them and is
  // dropped.
  if (o.gamma || o.amplitude) {
    for (const std::string& assignment : o.assignments)
      if (assignment.starts_with("drive."))
        throw ConfigError(
            {"--set", 0, 0, assignment},
            "and --drive-gamma or --drive-amplitude both set the drive; use only one of the two.");
    cell.drive_spec = {.amplitude = o.amplitude ? cell.drive_spec.amplitude : std::nullopt,
                       .omega = {},
                       .frequency = {},
                       .gamma = o.gamma ? cell.drive_spec.gamma : std::nullopt,
                       .k_m = {},
                       .peak_velocity = {}};
  }
  cell.phase_lock.check(Where{.file = {}, .key = "--first-phase"});
  return cell;
}

PhaseLock lock_of_chosen(PhaseLock lock, const FrameRange& range) {
  if (!lock.locked() || range.all()) return lock;
  if (lock.frames_per_cycle % range.step != 0)
    throw ConfigError(
        Where{.file = {}, .key = "--frames"},
        fmt::format("takes every frame number {}, which does not divide the {} frames per cycle.", range.step,
                    lock.frames_per_cycle));
  const std::int64_t first = (lock.first_phase + range.first) % lock.frames_per_cycle;
  lock.frames_per_cycle = static_cast<int>(lock.frames_per_cycle / range.step);
  lock.first_phase = static_cast<int>(first / range.step);
  lock.offset = (lock.offset + static_cast<double>(first % range.step)) / static_cast<double>(range.step);
  return lock;
}

}  // namespace twincell::imaging
