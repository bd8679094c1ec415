#pragma once
/// \file
/// Parameters of the linear contact law from the restitution and duration of a collision.
///
/// With w = pi/t_c and beta = -ln(e_n)/t_c (Fortini & Huang 2015, eq. A5, solved for its parameters):
///     k_n = m_eff (w^2 + beta^2),   gamma_n = 2 beta,   c_n = gamma_n m_eff.
/// sim::LinearCollision is the inverse.

#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace twincell::calibration {

/// Spring and dashpot of the linear law, reduced units.
struct SpringDashpot {
  double k_n = 0;      ///< m g/sigma
  double gamma_n = 0;  ///< damping rate, 1/t0
  double c_n = 0;      ///< dashpot constant, m/t0
};

/// Spring and dashpot for a given restitution and contact time.
/// \param restitution e_n in (0, 1]
/// \param contact_time t_c > 0, t0
/// \param m_eff > 0: 1/2 for two beads, 1 at a wall
/// \throws ConfigError naming the number and its bound
inline SpringDashpot spring_of(double restitution, double contact_time, double m_eff) {
  require_range({.file = {}, .key = "restitution"}, restitution, 0, 1, true);
  require_range({.file = {}, .key = "contact time"}, contact_time, 0, {}, true);
  require_range({.file = {}, .key = "m_eff"}, m_eff, 0, {}, true);
  const double w = std::numbers::pi / contact_time, beta = std::log(1 / restitution) / contact_time;
  return {.k_n = m_eff * (w * w + beta * beta), .gamma_n = 2 * beta, .c_n = 2 * beta * m_eff};
}

}  // namespace twincell::calibration
