#pragma once
/// \file
/// Dashpot with Coulomb slider, F_t = -min(c_t |v_t|, mu |F_n|) v_t/|v_t| (Bhateja et al. 2016, eq. A8).

#include <cmath>
#include <string_view>

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/lammps_contact.hpp"
#include "sim/laws/linear_collision.hpp"

namespace twincell::sim {

/// The law has no history and therefore no static friction: a bead on an incline creeps at m g
/// sin(theta)/c_t. F_n is the total normal force, including its dashpot.
struct DashpotSlider {
  static constexpr std::string_view kWord = "dashpot", kName = "dashpot with Coulomb slider";
  static constexpr std::string_view kHelp = "dashpot with Coulomb slider (second paper)";
  static constexpr const char* kKeys[] = {"mu", "gamma_t", "c_t", "c_t_over_c_n"};
  static constexpr int kConstants = 2;
  static constexpr bool kActs = true, kHistory = false;
  static constexpr std::string_view kInLammps = kWord;

  ViscousDamping damping;
  double mu = 0.6;

  static DashpotSlider read(const ContactTable& t) { return {read_tangential_damping(t), read_friction(t)}; }
  /// Without damping the dashpot exerts nothing, whatever mu is.
  [[nodiscard]] std::string_view why_no_force() const {
    return damping.eta(1) == 0 ? "is a dashpot without gamma_t, c_t or c_t_over_c_n" : "";
  }
  [[nodiscard]] double shortest_time(const PairScale& p) const {
    const double eta = damping.eta(p.m_eff);
    return eta > 0 ? 2 / (p.inv_m_t * eta) : HUGE_VAL;
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {-damping.eta(p.m_eff), mu};
  }
  void write_lammps(LammpsContact& contact, double m_eff) const {
    contact.gamma_t = damping.eta(m_eff) / m_eff;
    contact.mu = mu;
    contact.friction = true;
    contact.for_all_masses = contact.for_all_masses && damping.is_rate();
  }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V /*dt*/, X& /*xi*/) {
    return limited(c[0] * v_t, c[1] * abs(f_n)).value;
  }
  // The force in each of its two regimes, each also evaluated outside the range where it applies. An
  // integrator that changes regime only at the ends of its steps needs this (binary_collision.hpp).
  template <class V, class T>
  static T sticking(const V* c, const T& v_t) {
    return c[0] * v_t;
  }
  template <class V, class T>
  static T sliding(const V* c, const T& v_t, V f_n) {
    return (-(c[1] * abs(f_n)) / max(norm(v_t), V(kTiny))) * v_t;
  }
  /// Distance to the Coulomb limit at the tangential speed |v_t|, mu |F_n| - c_t |v_t|; negative where the
  /// force is truncated.
  template <class V>
  static V slack(const V* c, V speed, V f_n) {
    return fma(c[0], speed, c[1] * abs(f_n));
  }
};

}  // namespace twincell::sim
