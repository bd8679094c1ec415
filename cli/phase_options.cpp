// Options of the verbs that determine the drive phase of each frame.

#include "cli/phase_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "core/error.hpp"

namespace twincell::cli {

void add_phase_flags(CLI::App& verb, PhaseFlags& flags) {
  verb.add_option("--phase-lock", flags.phase_lock,
                  "Source of the drive phases: frames per drive cycle, 'found' (from the motion of the bed), "
                  "'none', or a list of triggers (*.csv)");
  verb.add_option(
          "--drive-hz", flags.drive_hz,
          "Frequency of the drive, Hz, for a list of triggers in seconds; default: the drive in CELL.toml")
      ->check(CLI::PositiveNumber);
}

PhaseSource phase_source(const PhaseFlags& o, CellDescription& cell, const std::string& cell_file) {
  PhaseSource source{.find = false, .triggers = {}, .drive_hz = o.drive_hz};
  const bool list = o.phase_lock.ends_with(".csv");
  const Where drive_hz{.file = {}, .key = "--drive-hz"};
  if (o.drive_hz && !list)
    throw ConfigError(drive_hz,
                      fmt::format("is {:g}, but it is used only with a list of triggers (--phase-lock "
                                  "FILE.csv); the drive of the cell is set by drive.frequency_hz.",
                                  *o.drive_hz));
  if (o.phase_lock.empty()) return source;
  int n = 0;
  const char* end = o.phase_lock.data() + o.phase_lock.size();
  if (const auto [last, error] = std::from_chars(o.phase_lock.data(), end, n);
      error == std::errc() && last == end) {
    cell.phase_lock.frames_per_cycle = n;
    if (cell.phase_lock.first_phase >= n) cell.phase_lock.first_phase = 0;
    cell.phase_lock.check(Where{.file = {}, .key = "phase-lock"});
  } else if (o.phase_lock == "found") {
    source.find = true;
  } else if (o.phase_lock == "none") {
    cell.phase_lock = {};
  } else if (list) {
    source.triggers = o.phase_lock;
    const auto drive = cell.drive();
    const auto t0 = cell.scale.t0_s();
    if (drive && t0) {
      constexpr double kSame = 1e-3;
      const double stated = drive->omega / (2 * M_PI * *t0);
      if (o.drive_hz && std::abs(*o.drive_hz / stated - 1) > kSame)
        throw ConfigError(drive_hz,
                          fmt::format("is {:g}, but the drive in {} is {:.6g} Hz; correct one of the two.",
                                      *o.drive_hz, cell_file, stated));
      if (!source.drive_hz) source.drive_hz = stated;
    }
  } else {
    throw ConfigError(
        Where{.file = {}, .key = "phase-lock"},
        "'" + o.phase_lock +
            "' is neither a number of frames per cycle, 'found', 'none', nor a list of triggers (*.csv).");
  }
  return source;
}

std::string phases_in_words(const PhaseTable& p) {
  std::string text;
  if (p.method == "none") {
    text = "phase lock: none\n";
  } else {
    text = fmt::format("phase lock: {}, {} frames per cycle", p.method, p.frames_per_cycle);
    if (p.period_frames) text += fmt::format(", period {:.4f} frames", *p.period_frames);
    if (!p.checked_by.empty()) text += ", checked by " + p.checked_by;
    if (!p.not_checked.empty()) text += " (not checked: " + p.not_checked + ")";
    if (p.offset != 0 && p.method == "triggers")
      text += fmt::format(", all {:+.3f} frames after their phases", p.offset);
    if (p.jitter)
      text += fmt::format(", jitter {}{:.3f} frames", p.method == "found" ? "at most " : "", *p.jitter);
    if (!p.frames.empty()) text += fmt::format(", {} frames dropped, {} taken twice", p.dropped, p.doubled);
    // No triggered camera is known to miss so many frames. A camera that runs free of the drive slips
    // continually.
    constexpr double kMostSlips = 0.1;
    if (p.method == "found" &&
        static_cast<double>(p.dropped + p.doubled) > kMostSlips * static_cast<double>(p.frames.size()))
      text += " (so many that the camera seems to run free of the drive; the phases are then meaningless)";
    if (p.agreement)
      text += fmt::format("; phase 0 placed by the drive, correlation {:.3f}", *p.agreement);
    else if (p.method == "found")
      text += "; phase 0 is where the bed passes its mean height upwards";
    text += '\n';
  }
  return text;
}

nlohmann::json json_of(const PhaseTable& p) {
  nlohmann::json lock = {{"way", p.method}};
  if (p.locked()) lock["frames_per_cycle"] = p.frames_per_cycle;
  lock["dropped"] = p.dropped;
  lock["doubled"] = p.doubled;
  if (!p.checked_by.empty()) lock["checked_by"] = p.checked_by;
  if (!p.not_checked.empty()) lock["not_checked"] = p.not_checked;
  if (!p.warning.empty()) lock["warning"] = p.warning;
  return lock;
}

}  // namespace twincell::cli
