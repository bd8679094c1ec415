#pragma once
/// \file
/// How a study of time steps names a setting, and its statistics of errors.

#include <string>
#include <vector>

namespace twincell::sim {

/// How a scene is stepped. Dampings and the tangential spring follow k_n (gamma ~ sqrt(k_n), k_t ~ k_n), so
/// that one collision is the same for every stiffness but for its duration.
struct StepSetting {
  std::string integrator = "verlet";  ///< time.integrator
  double n = 50.37;                   ///< steps per contact; a whole number hides errors of entry and exit
  double k_n = 1e6;                   ///< m g/sigma

  bool operator==(const StepSetting&) const = default;
};

/// An error over the entry phases of a collision: where within a step the contact begins.
struct PhaseSpread {
  double mean = 0, rms = 0, largest = 0;  ///< the last of the modulus

  /// Of what was measured, about what is exact.
  static PhaseSpread of(const std::vector<double>& values, double exact);
};

}  // namespace twincell::sim
