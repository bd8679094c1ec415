#pragma once
/// \file
/// Restitution, friction and tangential restitution from measured collisions, in Walton's representation
/// (Walton & Braun 1986; Foerster, Louge, Chang & Allia, Phys. Fluids 6, 1108, 1994).
///
/// With g the relative velocity of the surfaces at contact, g_n = -g.n > 0 the approach speed, Psi_1 =
/// g_t/g_n before and Psi_2 = g_t'/g_n after the collision (t along g_t before):
///     g_n' / g_n = e_n
///     sticking:  Psi_2 = -beta_0 Psi_1
///     sliding:   Psi_2 = Psi_1 - mu (1 + e_n) (1 + 1/K),    K = 4 I/(m d^2): 1/2 for discs, 2/5 for spheres
/// Psi_2 is the larger of the two branches.

#include <cstddef>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell::calibration {

/// One collision. An error of 0 is unknown; then all collisions have equal weight.
struct Impact {
  double speed = 0;             ///< g_n, sigma/t0
  double restitution = 0;       ///< g_n'/g_n
  double psi_1 = 0, psi_2 = 0;  ///< psi_1 >= 0; NaN if the spins are unknown
  double restitution_error = 0, psi_error = 0;
};

/// Collision parameters from the fit.
struct WaltonFit {
  std::size_t impacts = 0, outliers = 0;
  double restitution = 0, restitution_error = 0;
  double scatter = 0;                 ///< standard deviation of e_n between impacts, beyond the errors
  double slope = 0, slope_error = 0;  ///< de_n/d ln(speed); NaN if all speeds are equal
  /// "mu" and "beta_0"; `undetermined` lists those that the impacts do not determine.
  FitReport tangential;
  bool has_tangential = false;
  std::size_t sticking = 0, sliding = 0;
  std::vector<std::string> notes;
};

/// Fits e_n, its dependence on speed, and the two tangential branches, with outliers rejected.
/// \param shape K
/// \throws InputError for fewer than 3 finite impacts
WaltonFit fit_walton(const std::vector<Impact>& impacts, double shape);

}  // namespace twincell::calibration
