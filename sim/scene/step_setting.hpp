#pragma once
/// \file
/// Settings that a study of time steps compares, and statistics of their errors.

#include <string>
#include <vector>

namespace twincell::sim {

/// Time-step setting of a scene. Damping coefficients and the tangential spring scale with k_n (gamma ~
/// sqrt(k_n), k_t ~ k_n), so that for every stiffness a collision is the same except for its duration.
struct StepSetting {
  std::string integrator = "verlet";  ///< time.integrator
  double n = 50.37;                   ///< steps per contact; an integer hides the errors of entry and exit
  double k_n = 1e6;                   ///< m g/sigma

  bool operator==(const StepSetting&) const = default;
};

/// Statistics of an error over the entry phases of a collision (the positions within a step at which the
/// contact begins).
struct PhaseSpread {
  double mean = 0, rms = 0, largest = 0;  ///< `largest` is the largest modulus

  /// Statistics of the deviations of `values` from the exact value.
  static PhaseSpread of(const std::vector<double>& values, double exact);
};

}  // namespace twincell::sim
