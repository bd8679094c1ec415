#pragma once
/// \file
/// Normal laws. Linear spring-dashpot: F_n = k_n delta - eta v_n (Fortini & Huang 2015, eq. A2; Bhateja et
/// al. 2016, eq. A5), with eta = gamma_n m_eff (a rate, first paper) or c_n (a constant, second paper).

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace twincell::sim {

/// The closed forms of one collision of the linear law (MODEL: w0 = sqrt(k/m_eff), beta = eta/(2 m_eff)).
struct LinearCollision {
  double w0, beta;

  LinearCollision(double stiffness, double eta, double m_eff)
      : w0(std::sqrt(stiffness / m_eff)), beta(eta / (2 * m_eff)) {}
  [[nodiscard]] double damping_ratio() const { return beta / w0; }
  /// t_c = pi/sqrt(w0^2 - beta^2) (Fortini & Huang 2015, eq. A5); infinite if overdamped.
  [[nodiscard]] double contact_time() const {
    return damping_ratio() < 1 ? std::numbers::pi / std::sqrt(w0 * w0 - beta * beta) : HUGE_VAL;
  }
  /// e_n = exp(-beta t_c); 0 if overdamped.
  [[nodiscard]] double restitution() const {
    return damping_ratio() < 1 ? std::exp(-beta * contact_time()) : 0;
  }
};

/// eta that gives restitution e in (0, 1]: -2 ln(e) sqrt(k m_eff)/sqrt(pi^2 + ln^2 e) (Bhateja et al. 2016,
/// eq. A9, with the sign that dissipates).
inline double eta_of_restitution(double e, double stiffness, double m_eff) {
  const double l = std::log(e);
  return -2 * l * std::sqrt(stiffness * m_eff) / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
}

/// What damps: a rate (eta = gamma m_eff) and a constant (eta = c); usually one of them is zero.
struct ViscousDamping {
  double rate = 0;      ///< gamma_n, 1/t0
  double constant = 0;  ///< c_n, m/t0
  [[nodiscard]] double eta(double m_eff) const { return rate * m_eff + constant; }
};

/// Spring and dashpot without a clip: near the end of a contact the dashpot outweighs the spring and pulls.
/// Neither paper clips, and the closed forms hold only so.
struct LinearSpringDashpot {
  static constexpr std::string_view kName = "linear spring-dashpot";
  double stiffness = 0;  ///< k_n, m g/sigma
  ViscousDamping damping;

  double operator()(double overlap, double v_n, double m_eff) const {
    return stiffness * overlap - damping.eta(m_eff) * v_n;
  }
  [[nodiscard]] LinearCollision collision(double m_eff) const {
    return {stiffness, damping.eta(m_eff), m_eff};
  }
  /// t_c; where damping is strong the shorter of half an undamped period and the decay time of the dashpot.
  [[nodiscard]] double shortest_time(double m_eff) const {
    const LinearCollision c = collision(m_eff);
    const double swing = c.damping_ratio() < 1 ? c.contact_time() : std::numbers::pi / c.w0;
    return c.beta > 0 ? std::min(swing, 1 / c.beta) : swing;
  }
};

/// The same, the pull cut off: F_n >= 0. Raises e (bead-bead of the first paper: 0.8948 -> 0.8971).
struct ClippedSpringDashpot : LinearSpringDashpot {
  static constexpr std::string_view kName = "linear spring-dashpot, no tension";
  double operator()(double overlap, double v_n, double m_eff) const {
    return std::max(0.0, LinearSpringDashpot::operator()(overlap, v_n, m_eff));
  }
};

}  // namespace twincell::sim
