#pragma once
/// \file
/// The drive of a filmed cell from the motion of its plate, where the cell's description does not state it.

#include <filesystem>
#include <optional>
#include <string>

#include "calibration/drive/bed_drive.hpp"
#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"

namespace twincell {

/// Is there more to know of the drive than the cell says: amplitude and omega, or the frames per cycle?
bool lacks_drive(const CellDescription& cell);

/// Fills in what is lacking, from the plate's edge in every frame (cell_geometry.hpp, drive_fit.hpp): A from
/// the plate's amplitude and the scale, omega from the frames' rate and t0 where the cell states no omega,
/// frequency or strength that gives it; frames per cycle, first phase and offset. What the cell states stays.
/// \return what was measured, as one sentence
/// \throws ConfigError naming the key that is still missing and why it could not be measured; InputError if
/// no plate is seen to move
std::string complete_drive(CellDescription& cell, const std::filesystem::path& cell_file,
                           const std::filesystem::path& stack, int threads, Progress& progress);

/// The stated drive held against what the film shows.
struct DriveCheck {
  std::string by;                             ///< what showed the drive: "plate", "bed"; empty: nothing did
  std::string disagreement;                   ///< as one clause; empty if there is none
  std::string not_comparable;                 ///< why nothing showed the drive; empty if something did
  double amplitude = 0, amplitude_error = 0;  ///< as shown, sigma
  std::optional<double> frame_rate_hz;        ///< of the film, where it says one
};
/// Writes it into what the tracking says of itself: "drive_check" with "by", "amplitude", "amplitude_error"
/// or with "not_comparable", and "drive_disagreement" if there is one, by which `compare` refuses the
/// trajectory.
void record(const DriveCheck& check, TrajectoryInfo& info);

/// Holds the stated drive against the plate's edge in the first three cycles, at least 40 frames: amplitude,
/// and omega where the frames' rate and the scale say it. A difference counts if it is above five standard
/// errors, 3 % and 0.3 px. \pre the cell states drive and scale, otherwise nothing is compared
DriveCheck check_by_plate(const CellDescription& cell, const std::filesystem::path& stack, int threads,
                          Progress& progress);

/// Holds the stated drive against the lower side of the bed while that lies on the plate (bed_drive.hpp), for
/// films that do not show the plate. A difference counts if it is above five standard errors, 10 % and 0.3
/// px; omega, where the frames' rate and the scale say it, above five standard errors and 3 %. \pre `info`
/// holds the drive
DriveCheck check_by_bed(const BedSteps& bed, const TrajectoryInfo& info, std::optional<double> frame_rate_hz);

}  // namespace twincell
