#pragma once
/// \file
/// Phases from a list of triggers: a CSV file with one line per frame.
///
///     frame,time_s                 frame,cycles
///     0,0.0000                     0,0.000
///     1,0.0025                     1,0.050
///
/// `time_s` is the time of the exposure in seconds, counted from an instant at which the plate passes its
/// mean height upwards; it requires the frequency of the drive. `cycles` is the same in cycles of the drive.
/// Both count on through all cycles. `frame` may be absent if the lines are in order and none is missing.

#include <filesystem>
#include <optional>

#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Reads a list and rounds each frame to the nearest of N_k phases. The delay that the frames have in common
/// (their mean position between two phases, on the circle) is PhaseTable::offset and no jitter. If two frames
/// have the same phase of the same cycle, the second counts as doubled. Skipped phases count as dropped
/// frames. \param drive_hz frequency of the drive, required by `time_s` \param frames_per_cycle N_k; 0: one
/// over the median step in cycles, rounded \throws InputError naming file and line if the list cannot be
/// read, if times decrease or are all the same,
///     if a value is not a number, or if both time_s and cycles are present; as check_column_names
/// \throws ConfigError if the frequency is required but absent
PhaseTable read_triggers(const std::filesystem::path& file, std::optional<double> drive_hz,
                         int frames_per_cycle = 0);

}  // namespace twincell::imaging
