#pragma once
/// \file
/// The settings of a time step that studies of accuracy and cost vary.

#include <string>

namespace twincell::sim {

/// Time-step setting of a scene. Damping coefficients and the tangential spring scale with k_n (gamma ~
/// sqrt(k_n), k_t ~ k_n), so that for every stiffness a collision is the same except for its duration.
struct StepSetting {
  std::string integrator = "verlet";  ///< time.integrator
  double n = 50.37;                   ///< steps per contact; an integer hides the errors of entry and exit
  double k_n = 1e6;                   ///< m g/sigma

  bool operator==(const StepSetting&) const = default;
};

}  // namespace twincell::sim
