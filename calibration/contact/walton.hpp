#pragma once
/// \file
/// Restitution, friction and tangential restitution from measured collisions, in Walton's picture (Walton &
/// Braun 1986; Foerster, Louge, Chang & Allia, Phys. Fluids 6, 1108, 1994).
///
/// With g the velocity of the surfaces against each other, g_n = -g.n > 0 its approach and Psi_1 = g_t/g_n
/// before, Psi_2 = g_t'/g_n after (t along g_t before):
///     g_n' / g_n = e_n
///     sticking:  Psi_2 = -beta_0 Psi_1
///     sliding:   Psi_2 = Psi_1 - mu (1 + e_n) (1 + 1/K),    K = 4 I/(m d^2): 1/2 for discs, 2/5 for spheres
/// whichever is larger.

#include <cstddef>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell {

/// One collision. Uncertainties 0: unknown, all alike.
struct Impact {
  double speed = 0;             ///< g_n, sigma/t0
  double restitution = 0;       ///< g_n'/g_n
  double psi_1 = 0, psi_2 = 0;  ///< psi_1 >= 0; NaN where spins are not known
  double restitution_error = 0, psi_error = 0;
};

/// What the collisions say.
struct WaltonFit {
  std::size_t impacts = 0, outliers = 0;
  double restitution = 0, restitution_error = 0;
  double scatter = 0;                 ///< of e_n from impact to impact beyond its errors
  double slope = 0, slope_error = 0;  ///< de_n/d ln(speed); errors NaN where all speeds are alike
  /// "mu", "beta_0"; those the impacts leave open are in `undetermined`.
  FitReport tangential;
  bool has_tangential = false;
  std::size_t sticking = 0, sliding = 0;
  std::vector<std::string> notes;
};

/// \param shape K \throws InputError for fewer than 3 impacts that are finite
WaltonFit fit_walton(const std::vector<Impact>& impacts, double shape);

}  // namespace twincell
