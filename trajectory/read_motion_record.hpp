#pragma once
/// \file
/// Reads a record of a plate's motion (an encoder, a vibrometer, an accelerometer) from a CSV file and makes
/// a drive of it.

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "trajectory/recorded_motion.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// A record in reduced units, with equal steps of time.
struct MotionRecord {
  std::string file;            ///< its path, for messages
  std::string sha256;          ///< of the file, 64 hex digits
  std::string column;          ///< of the motion
  int derivative = 0;          ///< values are 0: displacements, 1: velocities, 2: accelerations
  double interval = 1;         ///< t0
  std::vector<double> values;  ///< sigma, sigma/t0 or sigma/t0^2
};

/// Reads a record. One column is the time (`time_s`, `time_ms` or `time_t0`), another the motion along the
/// axis of the drive (`position_mm`, `position_m`, `position_sigma`, `velocity_mm_s`, `velocity_m_s`,
/// `velocity_v0`, `acceleration_m_s2` or `acceleration_g`, in units of sigma/t0^2); other columns are
/// ignored.
/// \param scale converts laboratory units
/// \throws InputError naming file, column and row: as read_table; a column that is missing or stands twice;
/// fewer than 8 or more than kMaxSamples rows; a file above 256 MB; a row without a number; times that do not
/// ascend, of which rows are missing, or that depart from equal steps by more than a tenth of a step.
/// ConfigError at `where` if `scale` lacks a number that a unit requires
MotionRecord read_motion_record(const std::filesystem::path& path, const Scale& scale, const Where& where);

/// The record without its noise at high frequencies: y minimises sum (x - y)^2 + lambda sum (second
/// differences of y)^2 (Whittaker 1923), and the same filter of what it left out, x - y, is added. A sine of
/// frequency f keeps its phase and the share 1 - (r/(1 + r))^2 of its amplitude, r = (sin(pi f h)/sin(pi f_c
/// h))^4, h the interval; straight lines are kept.
/// \param cutoff frequency f_c, of which 3/4 of the amplitude remain, 1/t0; above 0 and below half the
/// sampling rate
/// \param repeats whether the first value follows the last
MotionRecord smoothed(MotionRecord record, double cutoff, bool repeats);

/// The motion of a record, and the amplitude of its component at the frequency of the drive.
struct FittedMotion {
  RecordedMotion motion;
  double amplitude = 0;  ///< A of A sin(omega t + phi), least squares, sigma
};

/// Interpolates a record by a cubic spline of its values and integrates it as often as needed. Integration
/// leaves constants that a record does not contain, and instruments have an offset: a polynomial of the
/// degree `derivative` (the mean height; for velocities a constant velocity too; for accelerations also a
/// constant acceleration) is fitted together with a sine of frequency omega, by least squares, and
/// subtracted. Of a repeated record the mean of the values and that of the motion are subtracted instead.
/// \param omega angular frequency of the drive, 1/t0
/// \param cycles whole cycles of a record that is repeated; 0: it is not repeated
/// \throws InputError if the record has fewer than 8 samples per cycle or, not repeated, fewer than two
/// cycles; if the last value of a repeated record does not lead to the first; for a displacement above
/// kLargestStroke
FittedMotion fit_motion(const MotionRecord& record, double omega, int cycles);

}  // namespace twincell
