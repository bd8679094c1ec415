#pragma once
/// \file
/// Linear spring and dashpot without tension: F_n = max(0, k_n delta - eta v_n) (Schwager & Poeschel 2007).

#include "sim/laws/normal/linear.hpp"

namespace twincell::sim {

/// The attraction at the end of a contact is removed, which raises e (bead-bead contact of Fortini & Huang:
/// 0.8948 -> 0.8971).
struct NoTensionSpringDashpot : LinearSpringDashpot {
  static constexpr std::string_view kWord = "linear-no-tension", kName = "linear spring-dashpot, no tension";
  static constexpr std::string_view kHelp = "never pulls";
  static constexpr bool kOmitsTension = true;
  static constexpr std::string_view kInLammps = kWord;

  static NoTensionSpringDashpot read(const ContactTable& t) { return {LinearSpringDashpot::read(t)}; }
  [[nodiscard]] Collision collision(const PairScale& p) const { return oscillator(p).without_pull(); }
  [[nodiscard]] Collision collision_with_tension(const PairScale& p) const {
    return LinearSpringDashpot::collision(p);
  }
  void write_lammps(LammpsContact& contact, double m_eff) const {
    LinearSpringDashpot::write_lammps(contact, m_eff);
    contact.clipped = true;
  }

  template <class V>
  static V force(const V* c, V overlap, V v_n, V* memory) {
    return max(V(0.0), force_with_tension(c, overlap, v_n, memory));
  }
  template <class V>
  static V force_with_tension(const V* c, V overlap, V v_n, V* memory) {
    return LinearSpringDashpot::force(c, overlap, v_n, memory);
  }
};

}  // namespace twincell::sim
