#pragma once
/// \file
/// Linear spring and dashpot, F_n = k_n delta - eta v_n (Fortini & Huang 2015, eq. A2; Bhateja et al. 2016,
/// eq. A5).

#include <string_view>

#include "sim/laws/lammps_contact.hpp"
#include "sim/laws/linear_collision.hpp"
#include "sim/laws/scalar_arithmetic.hpp"

namespace twincell::sim {

/// The force is not clipped: near the end of a contact the dashpot exceeds the spring and the contact pulls.
/// Neither paper clips it, and the closed forms of t_c and e_n require this.
struct LinearSpringDashpot {
  static constexpr std::string_view kWord = "linear", kName = "linear spring-dashpot";
  static constexpr std::string_view kHelp =
      "spring and dashpot, which may pull at the end of a contact, as in both papers";
  static constexpr const char* kKeys[] = {"k_n", "gamma_n", "c_n", "restitution"};
  static constexpr int kConstants = 2, kMemory = 0;
  /// One formula, also just outside the contact (binary_collision.hpp).
  static constexpr bool kSmooth = true;
  static constexpr std::string_view kInLammps = kWord;

  double k_n = 1e6;  ///< m g/sigma
  ViscousDamping damping;

  static LinearSpringDashpot read(const ContactTable& t) {
    const double k = read_stiffness(t);
    return {k, read_normal_damping(t, k)};
  }
  [[nodiscard]] LinearCollision oscillator(const PairScale& p) const {
    return {k_n, damping.eta(p.m_eff), p.m_eff};
  }
  [[nodiscard]] Collision collision(const PairScale& p) const { return oscillator(p).with_pull(); }
  [[nodiscard]] double shortest_time(const PairScale& p, double /*speed*/) const {
    return oscillator(p).shortest_time();
  }
  [[nodiscard]] double largest_force(double overlap) const { return k_n * overlap; }
  [[nodiscard]] bool is_elastic() const { return damping.eta(1) == 0; }
  [[nodiscard]] double impact_overlap(const PairScale& p, double speed) const {
    return speed * std::sqrt(p.m_eff / k_n);
  }
  void write_lammps(LammpsContact& contact, double m_eff) const {
    contact.k_n = k_n;
    contact.gamma_n = damping.eta(m_eff) / m_eff;
    contact.for_all_masses = contact.for_all_masses && damping.is_rate();
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {k_n, damping.eta(p.m_eff)};
  }

  template <class V>
  static V force(const V* c, V overlap, V v_n, V* /*memory*/) {
    return nfma(c[1], v_n, c[0] * overlap);
  }
};

}  // namespace twincell::sim
