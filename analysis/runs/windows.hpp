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

/// Divides a trajectory into windows of `cycles` cycles, from its first cycle or the first after
/// options.discard_cycles, and analyses each by itself. Cycles at the end that do not fill a window are left
/// out. The rest height, if `options` has none, is that of the whole trajectory.
/// \throws ConfigError for fewer than 1 cycle, options.cycles > 0, or a trajectory that has no cycle numbers
/// or is shorter than a window; as analyze
std::vector<Window> analyze_windows(const TrajectorySource& trajectory, const AnalysisOptions& options,
                                    std::int64_t cycles, Progress& progress = Progress::none());

/// The windows as a table, one row each: first_cycle, cycles, gamma_begin, gamma_end, omega_begin, omega_end
/// (g = 1, that is with gravity 1; empty if not known), then each result that is one number or a word, and
/// for a number the ends of its interval, as NAME, NAME_low, NAME_high; empty: absent.
std::string windows_csv(const std::vector<Window>& windows);

}  // namespace twincell::analysis
