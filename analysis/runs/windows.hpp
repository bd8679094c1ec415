#pragma once
/// \file
/// Analysis of a run in windows of cycles, for a run whose drive changes.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// One window and its results.
struct Window {
  std::int64_t first_cycle = 0, cycles = 0;
  /// The drive, without its ramp, where the window begins and where it ends; absent if the trajectory does
  /// not state it.
  std::optional<std::array<Drive, 2>> drive;
  std::vector<Result> results;
};

/// Numbers of the first and the last of consecutive cycles.
using CycleRange = std::array<std::int64_t, 2>;

/// Divides a trajectory into windows of `cycles` cycles, from its first cycle or the first after
/// options.discard_cycles, and analyses each by itself. Where a ramp turns back (drive.ramp.return) a window
/// begins, so that none contains both directions. Cycles before the turn and at the end that do not fill a
/// window are left out. The rest height, if `options` has none, is that of the whole trajectory.
/// \param left_out receives the cycles that are left out; null: not wanted
/// \throws ConfigError for fewer than 1 cycle, options.cycles > 0, or a trajectory that has no cycle numbers
/// or is shorter than a window; as analyze
std::vector<Window> analyze_windows(const TrajectorySource& trajectory, const AnalysisOptions& options,
                                    std::int64_t cycles, Progress& progress = Progress::none(),
                                    std::vector<CycleRange>* left_out = nullptr);

/// Names of the results that are one number or a word, or absent, in every window.
std::vector<std::string> names_of_numbers(const std::vector<Window>& windows);

/// The windows as a table, one row each: first_cycle, cycles, gamma_begin, gamma_end, omega_begin, omega_end
/// (g = 1, that is with gravity 1; empty if not known), then each result that is one number or a word, and
/// for a number the ends of its interval, as NAME, NAME_low, NAME_high; empty: absent. A result that is
/// absent in every window has the column NAME alone.
std::string windows_csv(const std::vector<Window>& windows);

}  // namespace twincell::analysis
