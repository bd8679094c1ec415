#pragma once
/// \file
/// Common code of the linear laws: the damping parameters in their three forms, and the closed-form solution
/// of one collision.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// Result of one head-on collision.
struct Collision {
  double duration;       ///< t0; infinite if the beads never separate
  double restitution;    ///< e_n
  double damping_ratio;  ///< zeta; overdamped for zeta >= 1
};

/// Closed-form solution of one collision under the linear law (w0 = sqrt(k/m_eff), beta = eta/(2 m_eff)).
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
  [[nodiscard]] Collision with_pull() const { return {contact_time(), restitution(), damping_ratio()}; }
  /// Duration, restitution and damping ratio if the force never pulls: the contact ends when the force is
  /// zero (Schwager & Poeschel 2007, eqs. 20-22). Overdamped beads separate too.
  [[nodiscard]] Collision without_pull() const {
    const double square = w0 * w0 - beta * beta;
    const double w = std::sqrt(std::abs(square));
    if (w < 1e-6 * w0) return {2 / w0, std::exp(-2), damping_ratio()};
    const double t = square > 0 ? (std::numbers::pi - std::atan2(2 * beta * w, w * w - beta * beta)) / w
                                : std::log((beta + w) / (beta - w)) / w;
    return {t, std::exp(-beta * t), damping_ratio()};
  }
  /// Time that a step must resolve, t0: t_c; with strong damping, the shorter of half an undamped period and
  /// the decay time of the dashpot.
  [[nodiscard]] double shortest_time() const {
    const double swing = damping_ratio() < 1 ? contact_time() : std::numbers::pi / w0;
    return beta > 0 ? std::min(swing, 1 / beta) : swing;
  }
};

/// Ratio v_t'/v_t of the tangential surface velocities after and before an impact of duration t_c without
/// slip, under a tangential spring and dashpot: exp(-a t_c) (cos(O t_c) - (a/O) sin(O t_c)), a = eta_t/(2
/// m_t), O^2 = k_t/m_t - a^2 (the damped oscillator; for imaginary O, cosh and sinh).
inline double sticking_ratio(double k_t, double eta_t, double inv_m_t, double t_c) {
  const double a = eta_t * inv_m_t / 2, square = k_t * inv_m_t - a * a, root = std::sqrt(std::abs(square));
  const double even = square > 0 ? std::cos(root * t_c) : std::cosh(root * t_c);
  const double odd = root == 0 ? t_c : (square > 0 ? std::sin(root * t_c) : std::sinh(root * t_c)) / root;
  return std::exp(-a * t_c) * (even - a * odd);
}

/// -2 ln(e)/sqrt(pi^2 + ln^2 e); multiplied by sqrt(k m_eff) it is the eta that gives restitution e in (0, 1]
/// (Bhateja et al. 2016, eq. A9, with the sign that dissipates).
[[gnu::always_inline]] inline double damping_of_restitution(double e) {
  const double l = std::log(e);
  return -2 * l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
}

/// Damping coefficient eta(m_eff) of a dashpot given as a rate (gamma), a constant (c) or a restitution.
/// Usually only one term is nonzero.
struct ViscousDamping {
  double rate = 0;      ///< gamma, 1/t0: eta = gamma m_eff
  double constant = 0;  ///< c, m/t0: eta = c
  double root = 0;      ///< eta = root sqrt(m_eff), from a restitution
  [[nodiscard]] double eta(double m_eff) const { return rate * m_eff + constant + root * std::sqrt(m_eff); }
  /// Whether eta is the same multiple of every m_eff.
  [[nodiscard]] bool is_rate() const { return constant == 0 && root == 0; }
  [[nodiscard]] ViscousDamping times(double f) const { return {f * rate, f * constant, f * root}; }
};

/// Reads the normal damping of a linear law: `gamma_n` (a rate, Fortini & Huang 2015), `c_n` (a constant) or
/// `restitution` (Bhateja et al. 2016). Without any of these keys the contact is undamped.
inline ViscousDamping read_normal_damping(const ContactTable& t, double stiffness) {
  const std::string key = t.which_of(normal_damping_keys());
  if (key == "gamma_n") return {t.required(key, 0), 0, 0};
  if (key == "c_n") return {0, t.required(key, 0), 0};
  if (key == "restitution") {
    if (t.required(key) == 0)
      throw ConfigError(
          t.where(key),
          "0 is out of range; the value must be greater than 0 and at most 1. Beads that do not "
          "part are critically damped: c_n = 2 sqrt(k_n m_eff), or gamma_n = 2 sqrt(k_n/m_eff).");
    return {0, 0, damping_of_restitution(t.required(key, 0, 1, true)) * std::sqrt(stiffness)};
  }
  return {};
}

/// Reads the stiffness `k_n`, m g/sigma, default 1e6 (Fortini & Huang 2015, Table I).
inline double read_stiffness(const ContactTable& t) {
  return t.number("k_n", 0, 1e12, true).value_or(1e6);
}

/// Reads the tangential damping: `gamma_t`, `c_t`, or `c_t_over_c_n` times the normal dashpot.
inline ViscousDamping read_tangential_damping(const ContactTable& t) {
  const std::string key = t.which_of(tangential_damping_keys());
  if (key == "gamma_t") return {t.required(key, 0), 0, 0};
  if (key == "c_t") return {0, t.required(key, 0), 0};
  if (key == "c_t_over_c_n") {
    if (t.which_of(normal_damping_keys()).empty())
      throw ConfigError(
          t.where(key),
          "there is no normal dashpot to take a multiple of; give c_n or restitution, which linear "
          "laws read, or gamma_t or c_t.");
    return read_normal_damping(t, read_stiffness(t)).times(t.required(key, 0));
  }
  return {};
}

}  // namespace twincell::sim
