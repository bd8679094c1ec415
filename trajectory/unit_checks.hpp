#pragma once
/// \file
/// Checks of the numbers of a shaken cell for wrong units.

#include <optional>
#include <string>
#include <vector>

#include "trajectory/drive.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// Numbers of a shaken cell. Absent values are unknown.
struct ShakenCell {
  std::optional<double> sigma_mm;      ///< bead diameter
  std::optional<double> frequency_hz;  ///< of the plate
  std::optional<double> gamma;         ///< A omega^2/g
  std::optional<double> gravity_m_s2;  ///< g
  std::optional<double> amplitude;     ///< A/sigma
};

/// The numbers of a cell from its scale and its drive, which is in reduced units.
ShakenCell shaken_cell(const Scale& scale, const std::optional<Drive>& drive);

/// One sentence for each number outside the range that shaken beads have: diameters of 0.02 to 100 mm,
/// frequencies of 0.1 to 2000 Hz, Gamma of 0.01 to 300, gravity of 0.01 to 100 m/s^2 (other than 1, which is
/// meant as 1 g), and amplitudes of 0.001 to 100 sigma at such a Gamma. Empty if all are inside.
std::vector<std::string> implausible_numbers(const ShakenCell& cell);

}  // namespace twincell
