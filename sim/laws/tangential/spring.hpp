#pragma once
/// \file
/// Tangential spring with history, dashpot and Coulomb limit, F_t = -(k_t xi + eta_t v_t), where xi is the
/// tangential displacement since first touch (Fortini & Huang 2015, eq. A3; Silbert et al. 2001).

#include <cmath>
#include <numbers>
#include <string_view>

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/linear_collision.hpp"
#include "sim/laws/tangential/dashpot.hpp"

namespace twincell::sim {

/// State of the spring while the surfaces slide, that is, where spring and dashpot together would exceed the
/// Coulomb limit mu |F_n|. The paper only says "truncate".
enum class SlipReading {
  rescale,         ///< spring shortened so that spring and dashpot together equal the limit (LAMMPS)
  spring_limited,  ///< spring alone kept at the limit, without the dashpot
  clip,            ///< only the force is cut; the spring continues to stretch
};

/// If |F_t| exceeds the limit mu |F_n|, the force is truncated to the limit and the spring is shortened so
/// that spring and dashpot together give exactly the limit. The paper says only "truncate"; this is the
/// common reading.
struct SpringSlider {
  static constexpr std::string_view kWord = "spring", kName = "spring with history, dashpot, Coulomb limit";
  static constexpr std::string_view kHelp =
      "spring with history, dashpot and Coulomb limit (first paper), at the limit the spring "
      "is shortened so that spring and dashpot together give exactly the limit";
  static constexpr const char* kKeys[] = {"mu", "k_t", "gamma_t", "c_t", "c_t_over_c_n"};
  static constexpr int kConstants = 4;
  static constexpr bool kActs = true, kHistory = true;
  static constexpr std::string_view kWithoutHistory = DashpotSlider::kWord;
  static constexpr SlipReading kReading = SlipReading::rescale;
  static constexpr std::string_view kInLammps = kWord;

  double k_t = 1e4;  ///< > 0, m g/sigma
  ViscousDamping damping;
  double mu = 0.6;

  static SpringSlider read(const ContactTable& t) {
    return {read_tangential_stiffness(t), read_tangential_damping(t), read_friction(t)};
  }
  [[nodiscard]] double shortest_time(const PairScale& p) const {
    const double eta = damping.eta(p.m_eff);
    const double swing = k_t > 0 ? std::numbers::pi / std::sqrt(k_t * p.inv_m_t) : HUGE_VAL;
    return eta > 0 ? std::min(swing, 2 / (p.inv_m_t * eta)) : swing;
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {-k_t, -damping.eta(p.m_eff), mu, k_t > 0 ? -1 / k_t : 0};  // signs as in the formula
  }
  void write_lammps(LammpsContact& contact, double m_eff) const {
    DashpotSlider{damping, mu}.write_lammps(contact, m_eff);
    contact.k_t = k_t;
    contact.history = true;
  }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V dt, X& xi) {
    return spring_slider(c, v_t, f_n, dt, xi);
  }
};

}  // namespace twincell::sim
