#pragma once
/// \file
/// Rolling resistance by a torsional spring and dashpot with a limit, M = -(k_r theta + c_r w),
/// |M| <= mu_r R_eff |F_n|, where theta is the angle rolled since first touch and w the relative angular
/// velocity (Ai et al., Powder Technol. 206, 269, 2011, model C).

#include <cmath>
#include <numbers>
#include <string_view>

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/parameters.hpp"

namespace twincell::sim {

/// If the torque exceeds the limit, the spring is shortened, as the tangential spring is (SpringSlider).
struct RollingSpring {
  static constexpr std::string_view kWord = "spring", kName = "torsional spring, dashpot, limit";
  static constexpr std::string_view kHelp =
      "torsional spring, dashpot and limit, without resistance to twisting about the normal";
  static constexpr const char* kKeys[] = {"k_r", "c_r", "mu_r"};
  static constexpr int kConstants = 4;
  static constexpr bool kActs = true;

  double k_r = 0;   ///< > 0, m g sigma per radian
  double c_r = 0;   ///< m sigma^2/t0 per radian
  double mu_r = 0;  ///< >= 0

  static RollingSpring read(const ContactTable& t) {
    return {t.required("k_r", 0, 1e12, true), t.number("c_r", 0, 1e12).value_or(0),
            t.required("mu_r", 0, 1e3)};
  }
  /// A lower bound of half the oscillation period pi sqrt(I/(2 k_r)) of the angle rolled, sqrt(6) below it
  /// for two equal discs; with damping, of the decay time of the dashpot if that is shorter. A torsional
  /// spring softer than k_t r^2 never sets the step.
  [[nodiscard]] double shortest_time(const PairScale& p) const {
    // 1/I of the pair is at most 4 inv_m_t/R^2 <= inv_m_t/r_eff^2 for discs and spheres.
    const double inv_inertia = p.inv_m_t / (p.r_eff * p.r_eff);
    const double swing = std::numbers::pi / std::sqrt(k_r * inv_inertia);
    return c_r > 0 ? std::min(swing, 2 / (c_r * inv_inertia)) : swing;
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {-k_r, -c_r, mu_r * p.r_eff, -1 / k_r};
  }

  template <class V, class T, class X>
  static T torque(const V* c, const T& w, V f_n, V dt, X& theta) {
    return spring_slider(c, w, f_n, dt, theta);
  }
};

}  // namespace twincell::sim
