#pragma once
/// \file
/// Linear spring and dashpot with a constant attraction while the surfaces touch, F_n = k_n delta - eta v_n -
/// F_c. F_c is the pull-off force of Derjaguin, Muller & Toporov (1975); there is no force at a distance.

#include "sim/laws/normal/linear.hpp"

namespace twincell::sim {

/// Beads at rest overlap by F_c/k_n. The Coulomb limit of friction is mu |F_n| with the total F_n. A contact
/// lasts until the surfaces separate: slow beads stay together (capture), fast beads separate with a
/// restitution that depends on the speed.
struct CohesiveSpringDashpot : LinearSpringDashpot {
  static constexpr std::string_view kWord = "cohesive",
                                    kName = "linear spring-dashpot, constant pull-off force";
  static constexpr std::string_view kHelp = "linear, with a constant attraction while the surfaces touch";
  static constexpr const char* kKeys[] = {"k_n", "gamma_n", "c_n", "restitution", "pull_off_force"};
  static constexpr int kConstants = 3;
  /// Excludes separate integration of a contact (separate_integration.hpp).
  static constexpr bool kAttracts = true;

  double pull_off_force = 0;  ///< F_c, m g

  static CohesiveSpringDashpot read(const ContactTable& t) {
    return {LinearSpringDashpot::read(t), t.required("pull_off_force", 0, 1e12)};
  }
  [[nodiscard]] double largest_force(double overlap) const { return k_n * overlap + pull_off_force; }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {k_n, damping.eta(p.m_eff), pull_off_force};
  }

  template <class V>
  static V force(const V* c, V overlap, V v_n, V* memory) {
    return LinearSpringDashpot::force(c, overlap, v_n, memory) - c[2];
  }
};

}  // namespace twincell::sim
