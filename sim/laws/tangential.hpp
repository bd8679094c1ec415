#pragma once
/// \file
/// Tangential laws: none; dashpot with Coulomb slider (Bhateja et al. 2016, eq. A8); spring with history,
/// dashpot and Coulomb limit (Fortini & Huang 2015, eq. A3). The Coulomb limit is mu |F_n| with F_n the total
/// normal force.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "sim/laws/normal.hpp"

namespace twincell::sim {

/// Smooth beads: no tangential force, hence no torque, no rotation, no history.
struct NoTangential {
  static constexpr std::string_view kName = "none";
  static constexpr bool kNeedsSpin = false, kNeedsHistory = false;
  double operator()(double, double, double, double, double&) const { return 0; }
  [[nodiscard]] double shortest_time(double, double) const { return HUGE_VAL; }
};

/// F_t = -min(c_t |v_t|, mu |F_n|) sign(v_t), 0 at v_t = 0. Has no static friction: a bead on an incline
/// creeps.
struct DashpotSlider {
  static constexpr std::string_view kName = "dashpot with Coulomb slider";
  static constexpr bool kNeedsSpin = true, kNeedsHistory = false;
  ViscousDamping damping;
  double mu = 0;

  double operator()(double v_t, double f_n, double m_eff, double, double&) const {
    const double limit = mu * std::abs(f_n);
    return std::clamp(-damping.eta(m_eff) * v_t, -limit, limit);
  }
  [[nodiscard]] double shortest_time(double m_eff, double m_t) const {
    const double eta = damping.eta(m_eff);
    return eta > 0 ? 2 * m_t / eta : HUGE_VAL;
  }
};

/// xi <- xi + v_t dt; F_t = -(k_t xi + eta_t v_t); beyond the Coulomb limit F_t is cut to it and the spring
/// shortened so that spring and dashpot together give exactly the limit. The paper says only "truncate"; this
/// is the common reading.
struct SpringSlider {
  static constexpr std::string_view kName = "spring with history, dashpot, Coulomb limit";
  static constexpr bool kNeedsSpin = true, kNeedsHistory = true;
  double stiffness = 0;  ///< k_t > 0
  ViscousDamping damping;
  double mu = 0;

  double operator()(double v_t, double f_n, double m_eff, double dt, double& xi) const {
    xi += v_t * dt;
    const double dashpot = damping.eta(m_eff) * v_t;
    const double trial = -(stiffness * xi + dashpot);
    const double limit = mu * std::abs(f_n);
    if (std::abs(trial) <= limit) return trial;
    const double force = std::copysign(limit, trial);
    xi = -(force + dashpot) / stiffness;
    return force;
  }
  [[nodiscard]] double shortest_time(double m_eff, double m_t) const {
    const double eta = damping.eta(m_eff);
    const double swing = std::numbers::pi / std::sqrt(stiffness / m_t);
    return eta > 0 ? std::min(swing, 2 * m_t / eta) : swing;
  }
};

/// The other reading of "truncate": the spring alone is held at the limit and the dashpot is dropped while
/// sliding. A different law: single collisions differ by per cents.
struct SpringOnlySlider : SpringSlider {
  static constexpr std::string_view kName = "spring with history, dashpot, limit on the spring alone";
  double operator()(double v_t, double f_n, double m_eff, double dt, double& xi) const {
    xi += v_t * dt;
    const double limit = mu * std::abs(f_n);
    const double spring = -stiffness * xi;
    if (std::abs(spring) <= limit) return std::clamp(spring - damping.eta(m_eff) * v_t, -limit, limit);
    const double force = std::copysign(limit, spring);
    xi = -force / stiffness;
    return force;
  }
};

}  // namespace twincell::sim
