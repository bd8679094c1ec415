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
/// With `frame`, the time of a frame that is out of lock is left empty ("7,"): it has no phase.

#include <filesystem>
#include <optional>

#include "imaging/phase/phase_lock.hpp"

namespace twincell::imaging {

/// Reads a list and sets the phases as set_phases_of_times.
/// \param drive_hz frequency of the drive, required by `time_s`
/// \param frames_per_cycle N_k; 0: one over the median step in cycles, rounded
/// \throws InputError naming file and line if the list cannot be read, if times decrease, are all the same or
/// all absent, if a value is not a number, or if both time_s and cycles are present; as check_column_names
/// \throws ConfigError if the frequency is required but absent
PhaseTable read_triggers(const std::filesystem::path& file, std::optional<double> drive_hz,
                         int frames_per_cycle = 0);

}  // namespace twincell::imaging
