#pragma once
/// \file
/// Phases from a list of triggers: a CSV file with one line per frame.
///
///     frame,time_s                 frame,cycles
///     0,0.0000                     0,0.000
///     1,0.0025                     1,0.050
///
/// `time_s` is the time of the exposure since the plate last passed its mean height upwards, in seconds, and
/// needs the frequency of the drive; `cycles` is the same in cycles of the drive. `frame` may be absent if
/// the lines are in order and none is missing.

#include <filesystem>
#include <optional>

#include "imaging/phase/phase_lock.hpp"

namespace twincell {

/// Reads a list and rounds each frame to the nearest of N_k phases. Two frames of one phase of one cycle: the
/// second is doubled; phases passed over: dropped.
/// \param drive_hz frequency of the drive, needed by `time_s`
/// \param frames_per_cycle N_k; 0: one over the median step, rounded
/// \throws InputError naming file and line if the list cannot be read, times fall or are all the same, a
/// value
///     is no number, or both time_s and cycles are there; as check_column_names; ConfigError if the frequency
///     is needed and absent
PhaseTable read_triggers(const std::filesystem::path& file, std::optional<double> drive_hz,
                         int frames_per_cycle = 0);

}  // namespace twincell
