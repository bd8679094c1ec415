// Options of the verbs that determine the drive phase of each frame.

#include "cli/phase_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "core/choice.hpp"
#include "core/plural.hpp"

namespace twincell::cli {

namespace {

// The values of --phase-lock with their help.
std::string phase_methods_help() {
  std::string text;
  for (const imaging::PhaseMethodRow& row : imaging::kPhaseMethods)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", row.option, row.help);
  return text;
}

}  // namespace

void add_phase_options(CLI::App& verb, imaging::PhaseRequest& request) {
  const OptionHeading heading(verb, "Phases of the drive");
  verb.add_option("--phase-lock", request.phase_lock, "Source of the drive phases. " + phase_methods_help());
  verb.add_option(
          "--drive-hz", request.drive_hz,
          "Frequency of the drive, Hz, for a list of triggers in seconds; default: the drive in CELL.toml")
      ->check(above_zero());
}

std::string phases_in_words(const imaging::PhaseTable& p) {
  std::string text;
  if (p.method == imaging::PhaseMethod::none) {
    text = "phase lock: none\n";
  } else {
    text = fmt::format("phase lock: {}, {} frames per cycle", row_of(imaging::kPhaseMethods, p.method).word,
                       p.frames_per_cycle);
    if (p.period_frames) text += fmt::format(", period {:.4f} frames", *p.period_frames);
    if (!p.checked_by.empty())
      text += (p.method == imaging::PhaseMethod::found ? ", by " : ", checked by ") + p.checked_by;
    if (!p.not_checked.empty()) text += " (not checked: " + p.not_checked + ")";
    if (p.offset != 0 && p.method == imaging::PhaseMethod::triggers)
      text += fmt::format(", all {:+.3f} frames after their phases", p.offset);
    if (p.jitter)
      text += fmt::format(", jitter {}{:.3f} frames",
                          p.method == imaging::PhaseMethod::found ? "at most " : "", *p.jitter);
    if (!p.frames.empty())
      text += fmt::format(", {} dropped, {} taken twice", plural(p.dropped, "frame"), p.doubled);
    if (p.between > 0) text += fmt::format(", {} between two phases", plural(p.between, "frame"));
    if (!p.out_of_lock.empty())
      text += fmt::format(", {} out of lock", plural(frames_in(p.out_of_lock), "frame"));
    // No triggered camera is known to miss so many frames. A camera that runs free of the drive slips
    // continually; one whose frames are only repeated, with clear phases between them, does not.
    constexpr double kMaxSlips = 0.1, kClear = 0.15;
    if (p.method == imaging::PhaseMethod::found &&
        static_cast<double>(p.dropped + p.doubled) > kMaxSlips * static_cast<double>(p.frames.size()))
      text +=
          p.dropped == 0 && p.jitter.value_or(0) < kClear
              ? " (so many repeated frames come from a conversion of the frame rate, or from a bed at rest; "
                "each instant counts once)"
              : " (so many that the camera seems to run free of the drive; the phases are then meaningless)";
    if (p.agreement)
      text += fmt::format("; phase 0 placed by the drive, correlation {:.3f}", *p.agreement);
    else if (p.method == imaging::PhaseMethod::found && p.checked_by.empty())
      text += "; phase 0 is where the bed passes its mean height upwards";
    text += '\n';
  }
  return text;
}

nlohmann::json json_of(const imaging::PhaseTable& p) {
  nlohmann::json lock = {{"method", row_of(imaging::kPhaseMethods, p.method).word}};
  if (p.locked()) lock["frames_per_cycle"] = p.frames_per_cycle;
  lock["dropped"] = p.dropped;
  lock["doubled"] = p.doubled;
  if (!p.out_of_lock.empty()) lock["out_of_lock"] = frames_in(p.out_of_lock);
  if (p.between > 0) lock["between_phases"] = p.between;
  if (!p.checked_by.empty()) lock["checked_by"] = p.checked_by;
  if (!p.not_checked.empty()) lock["not_checked"] = p.not_checked;
  if (!p.warning.empty()) lock["warning"] = p.warning;
  return lock;
}

}  // namespace twincell::cli
