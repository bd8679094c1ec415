#pragma once
/// \file
/// Hertz contact with viscoelastic damping, F_n = max(0, rho sqrt(delta) (delta - 3/2 A v_n)),
/// rho = 2 Y sqrt(R_eff)/(3 (1 - nu^2)) (Hertz 1882; Brilliantov, Spahn, Hertzsch & Poeschel 1996).

#include <cmath>
#include <string_view>

#include "sim/laws/parameters.hpp"
#include "sim/laws/scalar_arithmetic.hpp"

namespace twincell::sim {

/// Beads and walls are of one material with Young's modulus Y, Poisson's ratio nu and viscous time A. The
/// restitution decreases with the impact speed, 1 - e ~ v^(1/5).
struct HertzViscoelastic {
  static constexpr std::string_view kWord = "hertz", kName = "Hertz, viscoelastic damping";
  static constexpr std::string_view kHelp = "viscoelastic spheres";
  static constexpr const char* kKeys[] = {"youngs_modulus", "poisson_ratio", "viscous_time"};
  static constexpr int kConstants = 2, kMemory = 0;

  double youngs_modulus = 0;  ///< Y, m g/sigma^2
  double poisson_ratio = 0;   ///< nu, 0 .. 0.5
  double viscous_time = 0;    ///< A, t0

  static HertzViscoelastic read(const ContactTable& t) {
    return {t.required("youngs_modulus", 0, 1e15, true), t.number("poisson_ratio", 0, 0.5).value_or(0.3),
            t.number("viscous_time", 0, 1).value_or(0)};
  }
  /// The coefficient rho in F = rho delta^(3/2), m g/sigma^(3/2).
  [[nodiscard]] double stiffness(double r_eff) const {
    return 2 * youngs_modulus * std::sqrt(r_eff) / (3 * (1 - poisson_ratio * poisson_ratio));
  }
  /// Duration, t0, of an elastic impact at `speed`, t = 3.2180 (m_eff/rho)^(2/5) v^(-1/5): faster impacts are
  /// shorter. With damping A, the shorter of t and t^2/(15 A).
  [[nodiscard]] double shortest_time(const PairScale& p, double speed) const {
    const double swing = 3.2180 * std::pow(p.m_eff / stiffness(p.r_eff), 0.4) * std::pow(speed, -0.2);
    return viscous_time > 0 ? std::min(swing, swing * swing / (15 * viscous_time)) : swing;
  }
  /// Force at an overlap for R_eff = 1 sigma, an upper bound if R_eff <= 1 in all contacts, as between beads
  /// up to a radius of 2 sigma, and at walls up to 1 sigma. A contact of larger R_eff exceeds it by the
  /// factor sqrt(R_eff). The only consequence is a coarser rounding quantum (rounding_constant()).
  [[nodiscard]] double largest_force(double overlap) const { return stiffness(1) * std::pow(overlap, 1.5); }
  [[nodiscard]] bool is_elastic() const { return viscous_time == 0; }
  /// The stiffness grows with the overlap as that of Mindlin does: one limit resolves both (V2.17).
  [[nodiscard]] double impact_overlap(const PairScale& /*p*/, double /*speed*/) const { return 0; }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {stiffness(p.r_eff), 1.5 * viscous_time};
  }

  template <class V>
  static V force(const V* c, V overlap, V v_n, V* /*memory*/) {
    const V root = sqrt(max(overlap, V(0.0)));
    return max(V(0.0), c[0] * root * nfma(c[1], v_n, overlap));
  }
};

}  // namespace twincell::sim
