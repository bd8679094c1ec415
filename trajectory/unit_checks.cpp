#include "trajectory/unit_checks.hpp"

#include <fmt/format.h>

#include <numbers>

namespace twincell {

ShakenCell shaken_cell(const Scale& scale, const std::optional<Drive>& drive) {
  ShakenCell numbers;
  if (scale.sigma_m) numbers.sigma_mm = *scale.sigma_m * 1e3;
  if (scale.gravity_m_s2) numbers.gravity_m_s2 = *scale.gravity_m_s2 * (drive ? drive->gravity : 1);
  if (!drive || !(drive->amplitude > 0)) return numbers;
  numbers.gamma = drive->gamma();
  numbers.amplitude = drive->amplitude;
  if (const auto t0 = scale.t0_s()) numbers.frequency_hz = drive->omega / (2 * std::numbers::pi * *t0);
  return numbers;
}

std::vector<std::string> implausible_numbers(const ShakenCell& cell) {
  std::vector<std::string> doubts;
  const auto check = [&](const char* what, const std::optional<double>& value, double low, double high,
                         const char* unit, const char* question) {
    if (!value || (*value >= low && *value <= high)) return true;
    doubts.push_back(fmt::format("{} is {:.3g}{}, but {:g} to {:g}{} is usual for shaken beads; {}", what,
                                 *value, unit, low, high, unit, question));
    return false;
  };
  check("the bead diameter", cell.sigma_mm, 0.02, 100, " mm", "is it in mm?");
  check("the frequency of the plate", cell.frequency_hz, 0.1, 2000, " Hz", "is it in Hz?");
  if (check("Gamma = A omega^2/g", cell.gamma, 0.01, 300, "",
            "are diameter and frequency in the units that their keys name?"))
    check("the amplitude of the plate", cell.amplitude, 0.001, 100, " sigma",
          "is the frequency in the unit that its key names? Without one, times are in t0 = sqrt(sigma/g).");
  check("gravity", cell.gravity_m_s2, 0.01, 100, " m/s^2", "is it in m/s^2?");
  if (cell.gravity_m_s2 == 1.0) doubts.emplace_back("gravity is 1 m/s^2; if 1 g is meant, it is 9.81 m/s^2.");
  return doubts;
}

}  // namespace twincell
