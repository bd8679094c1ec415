#pragma once
/// \file
/// The drive as an accelerometer on the plate saw it.

#include <filesystem>
#include <vector>

namespace twincell {

/// A record: columns `time_s` and `acceleration_m_s2` of a CSV table.
struct VibrationTable {
  std::string file;
  std::vector<double> time_s, acceleration;
};
/// \throws InputError, ConfigError as read_table
VibrationTable read_vibration(const std::filesystem::path& file);

/// Frequency and amplitude of its fundamental, |a| = A omega^2, with standard errors.
struct VibrationFit {
  double frequency_hz = 0, frequency_error = 0;
  double acceleration = 0, acceleration_error = 0;  ///< m/s^2
};
/// The same robust harmonic fit as of the plate's heights (drive_fit.hpp). Samples need equal steps in time
/// to one per cent. \throws InputError naming the file
VibrationFit fit_vibration(const VibrationTable& table);

}  // namespace twincell
