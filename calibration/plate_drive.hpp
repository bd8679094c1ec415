#pragma once
/// \file
/// The drive of a filmed cell from the motion of its plate, where the cell's description does not state it.

#include <filesystem>
#include <string>

#include "analysis/trajectory/progress.hpp"
#include "imaging/cell.hpp"

namespace twincell {

/// Is there more to know of the drive than the cell says: amplitude and omega, or the frames per cycle?
bool lacks_drive(const CellDescription& cell);

/// Fills in what is lacking, from the plate's edge in every frame (cell_geometry.hpp, plate_lock.hpp): A from
/// the plate's amplitude and the scale, omega from the frames' rate and t0 where the cell states no omega,
/// frequency or strength that gives it; frames per cycle, first phase and offset. What the cell states stays.
/// \return what was measured, as one sentence
/// \throws ConfigError naming the key that is still missing and why it could not be measured; InputError if
/// no plate is seen to move
std::string complete_drive(CellDescription& cell, const std::filesystem::path& cell_file,
                           const std::filesystem::path& stack, int threads, Progress& progress);

/// Holds the stated drive against the plate's edge in the first three cycles, at least 40 frames: amplitude,
/// and omega where the frames' rate and the scale say it. A difference counts if it is above five standard
/// errors, 3 % and 0.3 px. \return the disagreement as one clause; empty if there is none, or if no plate is
/// seen to move \pre the cell states drive and scale
std::string drive_disagreement(const CellDescription& cell, const std::filesystem::path& stack, int threads,
                               Progress& progress);

}  // namespace twincell
