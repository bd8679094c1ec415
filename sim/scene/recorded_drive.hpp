#pragma once
/// \file
/// The drive of a scene that names a record of its motion (`drive.file`).

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/units.hpp"

namespace twincell::sim {

/// The keys `file`, `repeat`, `cutoff` and `file_sha256` of `[drive]`.
struct DriveRecord {
  std::filesystem::path file;  ///< relative to the scene's folder; empty: the drive is a formula
  bool repeats = false;        ///< the record contains whole cycles and is repeated
  std::string sha256;          ///< the digest that the file must have; empty: any
  double cutoff = 0;           ///< frequency above which the record is smoothed, 1/t0; 0: it is not
};

/// Reads the record and makes the drive of it. omega is the frequency that `spec` states; a repeated record
/// may instead set it, and has one cycle if none is stated. A number of `spec` that fixes the amplitude
/// scales the record so that its sine has this amplitude; without one it is as recorded.
/// \param gravity magnitude of g, to which Gamma and K_m refer
/// \param drive the table, for messages
/// \throws ConfigError if omega is missing, if the cycles of a repeated record are not a whole number within
/// 1 %, if the cutoff is below twice the frequency or not below half the sampling rate, or if a record
/// without motion at omega is to be scaled; InputError if the file has another digest; as
/// read_motion_record, fit_motion and solve_drive
Drive recorded_drive(const DriveRecord& record, DriveSpec spec, double gravity, const Scale& scale,
                     const ConfigSection& drive, Axis axis);

/// Share of the mean square of the displacement that the sine A sin(omega t) of a recorded drive has, at
/// most 1.
double share_of_sine(const Drive& drive);

/// \throws ConfigError at `where` if the record of a drive ends before `cycles` cycles
void require_record_lasts(const Drive& drive, std::int64_t cycles, const Where& where);

/// What `explain` says about a drive that is not a sine: extremes, for a record its length and the share of
/// its sine, the end of a ramp, the strength of a horizontal motion. Empty for a sine.
/// \param gravity magnitude of g; 0: none
std::string beyond_the_sine(const Drive& drive, double gravity);

/// Doubts about the record of a drive, if it has one: cut off by the instrument, of a strength or a mean that
/// suggest another unit, hardly a sine, or noisy.
std::vector<std::string> warnings_of_record(const Drive& drive);

}  // namespace twincell::sim
