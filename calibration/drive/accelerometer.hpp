#pragma once
/// \file
/// Frequency and acceleration amplitude of the drive from an accelerometer on the plate.

#include <filesystem>
#include <string>
#include <vector>

namespace twincell::calibration {

/// An accelerometer record: columns `time_s` and `acceleration_m_s2` of a CSV table.
struct VibrationTable {
  std::string file;
  std::vector<double> time_s, acceleration;
};
/// Reads a record from a CSV file.
/// \throws InputError, ConfigError as read_table
VibrationTable read_vibration(const std::filesystem::path& file);

/// Frequency and acceleration amplitude A omega^2 of the fundamental, with standard errors.
struct VibrationFit {
  double frequency_hz = 0, frequency_error = 0;
  double acceleration = 0, acceleration_error = 0;  ///< m/s^2
  std::vector<std::string> doubts;                  ///< sentences: cut off by the instrument, another unit
};
/// Applies the robust harmonic fit of the plate's heights (drive_fit.hpp) to the accelerations.
/// \throws InputError naming the file, for fewer than 8 samples, or for times that depart from equal steps by
/// more than 1 % of the record
VibrationFit fit_vibration(const VibrationTable& table);

}  // namespace twincell::calibration
