#include "calibration/drive/accelerometer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "calibration/drive/drive_fit.hpp"
#include "core/error.hpp"
#include "core/table.hpp"
#include "trajectory/record_doubts.hpp"

namespace twincell::calibration {

VibrationTable read_vibration(const std::filesystem::path& file) {
  const Table table = read_table(file);
  return {.file = table.file,
          .time_s = table.column("time_s"),
          .acceleration = table.column("acceleration_m_s2")};
}

VibrationFit fit_vibration(const VibrationTable& table) {
  constexpr std::size_t kMinValues = 8;  // for amplitude, period and phase
  const std::size_t n = table.time_s.size();
  if (n < kMinValues)
    throw InputError({.file = table.file, .key = "acceleration_m_s2"},
                     fmt::format("holds {} values; a fit needs {}.", n, kMinValues));
  const double step = n > 1 ? (table.time_s.back() - table.time_s.front()) / static_cast<double>(n - 1) : 0;
  for (std::size_t i = 0; i < n; ++i)
    if (!(std::abs(table.time_s[i] - table.time_s.front() - static_cast<double>(i) * step) <=
          0.01 * step * static_cast<double>(n)) ||
        !(step > 0))
      throw InputError({.file = table.file, .key = "time_s"}, "does not rise in equal steps.");
  DriveFit lock;
  try {
    lock = fit_drive(table.acceleration, {.frames_per_cycle = 0, .mend = false});
  } catch (const InputError& e) {
    throw InputError({.file = table.file, .key = "acceleration_m_s2"}, e.what());
  }
  std::vector<double> in_g = table.acceleration;
  for (double& a : in_g) a /= kStandardGravity;
  std::vector<std::string> doubts;
  for (const std::string& doubt : {doubt_of_clipping(in_g), doubt_of_unit(in_g)})
    if (!doubt.empty()) doubts.push_back("acceleration_m_s2 of " + table.file + ": " + doubt);
  const double hz = 1 / (2 * std::numbers::pi * step);
  return {.frequency_hz = lock.omega * hz,
          .frequency_error = lock.omega_error * hz,
          .acceleration = lock.amplitude,
          .acceleration_error = lock.amplitude_error,
          .doubts = std::move(doubts)};
}

}  // namespace twincell::calibration
