#pragma once
/// \file
/// What the linear laws share: damping in its three spellings, and the closed forms of one collision.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// What one head-on collision comes to.
struct Collision {
  double duration;       ///< t0; infinite if the spring never drives the beads apart
  double restitution;    ///< e_n
  double damping_ratio;  ///< zeta; from 1 on overdamped
};

/// The closed forms of one collision of the linear law (w0 = sqrt(k/m_eff), beta = eta/(2 m_eff)).
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
  /// The same where the force never pulls: the contact ends when it is zero (Schwager & Poeschel 2007,
  /// eqs. 20-22). Overdamped beads part too.
  [[nodiscard]] Collision without_pull() const {
    const double square = w0 * w0 - beta * beta;
    const double w = std::sqrt(std::abs(square));
    if (w < 1e-6 * w0) return {2 / w0, std::exp(-2), damping_ratio()};
    const double t = square > 0 ? (std::numbers::pi - std::atan2(2 * beta * w, w * w - beta * beta)) / w
                                : std::log((beta + w) / (beta - w)) / w;
    return {t, std::exp(-beta * t), damping_ratio()};
  }
  /// What a step must resolve: t_c; where damping is strong the shorter of half an undamped period and the
  /// decay time of the dashpot.
  [[nodiscard]] double shortest_time() const {
    const double swing = damping_ratio() < 1 ? contact_time() : std::numbers::pi / w0;
    return beta > 0 ? std::min(swing, 1 / beta) : swing;
  }
};

/// v_t'/v_t of the surfaces of an impact that lasts t_c and does not slip, with a tangential spring and
/// dashpot: exp(-a t_c) (cos(O t_c) - (a/O) sin(O t_c)), a = eta_t/(2 m_t), O^2 = k_t/m_t - a^2 (the damped
/// oscillator; O imaginary: cosh and sinh).
inline double sticking_ratio(double k_t, double eta_t, double inv_m_t, double t_c) {
  const double a = eta_t * inv_m_t / 2, square = k_t * inv_m_t - a * a, root = std::sqrt(std::abs(square));
  const double even = square > 0 ? std::cos(root * t_c) : std::cosh(root * t_c);
  const double odd = root == 0 ? t_c : (square > 0 ? std::sin(root * t_c) : std::sinh(root * t_c)) / root;
  return std::exp(-a * t_c) * (even - a * odd);
}

/// -2 ln(e)/sqrt(pi^2 + ln^2 e): times sqrt(k m_eff) it is the eta that gives restitution e in (0, 1]
/// (Bhateja et al. 2016, eq. A9, with the sign that dissipates).
[[gnu::always_inline]] inline double damping_of_restitution(double e) {
  const double l = std::log(e);
  return -2 * l / std::sqrt(std::numbers::pi * std::numbers::pi + l * l);
}

/// eta(m_eff) of a dashpot given as a rate (gamma), a constant (c) or a restitution; usually one term is not
/// zero.
struct ViscousDamping {
  double rate = 0;      ///< gamma, 1/t0: eta = gamma m_eff
  double constant = 0;  ///< c, m/t0: eta = c
  double root = 0;      ///< eta = root sqrt(m_eff), from a restitution
  [[nodiscard]] double eta(double m_eff) const { return rate * m_eff + constant + root * std::sqrt(m_eff); }
  [[nodiscard]] ViscousDamping times(double f) const { return {f * rate, f * constant, f * root}; }
};

/// Normal damping of a linear law: `gamma_n` (a rate, Fortini & Huang 2015), `c_n` (a constant) or
/// `restitution` (Bhateja et al. 2016); none of them: undamped.
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

/// Stiffness `k_n`, m g/sigma, default 1e6 (Fortini & Huang 2015, Table I).
inline double read_stiffness(const ContactTable& t) {
  return t.number("k_n", 0, 1e12, true).value_or(1e6);
}

/// Tangential damping: `gamma_t`, `c_t`, or `c_t_over_c_n` times the normal dashpot.
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
