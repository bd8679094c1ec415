#pragma once
/// \file
/// Drive of a filmed cell: measured from its plate if the cell description does not state it, otherwise
/// checked against the plate or the bed.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "calibration/drive/bed_drive.hpp"
#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/stack/chosen_frames.hpp"

namespace twincell::calibration {

/// Whether the cell description lacks the amplitude or frequency of the drive, or, if `phases` are wanted,
/// the frames per cycle.
bool lacks_drive(const imaging::CellDescription& cell, bool phases = true);

/// A cell with its drive, and the values measured for it.
struct CompletedDrive {
  imaging::CellDescription cell;
  std::string measured;  ///< the measured values as one sentence; empty if the cell stated them all
};

/// Completes the drive of a cell from the plate's edge in every frame (cell_geometry.hpp, drive_fit.hpp). A
/// comes from the plate's amplitude and the scale. omega comes from the frame rate and t0, unless the cell
/// states omega, a frequency or a strength that gives it. Frames per cycle, first phase and offset come from
/// the fit if `phases` are wanted. Values that the cell states are kept.
/// \param range the frames of the stack that are read, and to which the phases of the cell refer
/// \throws ConfigError naming the key that is still missing and why it could not be measured; InputError if
/// no moving plate is detected
CompletedDrive complete_drive(imaging::CellDescription cell, bool phases,
                              const std::filesystem::path& cell_file, const std::filesystem::path& stack,
                              const imaging::FrameRange& range, int threads, Progress& progress);

/// Result of comparing the stated drive with the film.
struct DriveCheck {
  std::string by;                             ///< source of the measured drive: "plate", "bed"; empty: none
  std::string disagreement;                   ///< as one clause; empty if the two agree
  std::string doubt;                          ///< a smaller difference of the amplitude, as one clause
  std::string not_comparable;                 ///< why the drive was not measured; empty if it was
  double amplitude = 0, amplitude_error = 0;  ///< measured, sigma
  std::optional<double> frame_rate_hz;        ///< of the film, if known
  /// A clause: an edge moves as a plate does, but neither at the stated place nor with the stated amplitude.
  std::string plate_elsewhere;
};
/// The check as members of the report of a tracked film: "drive_check" with "by", "amplitude",
/// "amplitude_error" or with "not_comparable", and "drive_disagreement" if there is one. `compare` refuses a
/// trajectory with "drive_disagreement".
nlohmann::json report_of(const DriveCheck& check);

/// Compares the stated drive with the plate's edge in the first three cycles, at least 40 frames: the
/// amplitude, the period in frames, and omega if frame rate and scale are known. A difference counts if it
/// exceeds five standard errors, 3 % and 0.3 px (period and omega: five standard errors and 3 %). A smaller
/// difference of the amplitude is a doubt above five standard errors, 0.5 % and 0.05 px.
/// \param range the frames of the stack that are read, and to which the phases of the cell refer
/// \param fixed_phases whether the phases of the frames follow from the stated frames per cycle; otherwise
/// the period is not compared. Also compares omega with the stated frame rate divided by the stated frames
/// per cycle, with or without a plate in the picture. A plate that is more than two bead diameters from
/// camera.origin_px is a difference too, and so is a second harmonic that differs from the stated one by more
/// than 3 % of A and five standard errors.
/// \pre the cell states drive and scale, otherwise nothing is compared
DriveCheck check_by_plate(const imaging::CellDescription& cell, const std::filesystem::path& stack,
                          const imaging::FrameRange& range, int threads, Progress& progress,
                          bool fixed_phases = true);

/// Compares the stated drive with the lower surface of the bed while the bed rests on the plate
/// (bed_drive.hpp), for films that do not show the plate. A difference of amplitude counts if it exceeds five
/// standard errors, 10 % and 0.3 px. omega is compared if frame rate and scale are known; a difference counts
/// above five standard errors and 3 %.
/// \pre `info` states the drive
DriveCheck check_by_bed(const BedSteps& bed, const TrajectoryInfo& info, std::optional<double> frame_rate_hz);

/// The same after check_by_plate, which found no plate where the cell states it. If the bed cannot be
/// compared either, a plate elsewhere counts as a difference: the cell file is that of another stack.
/// \pre as above
DriveCheck check_by_bed(const BedSteps& bed, const TrajectoryInfo& info, const DriveCheck& by_plate);

}  // namespace twincell::calibration
