#pragma once
/// \file
/// Tangential spring whose stiffness follows the contact area, F_t = -8 G* sqrt(R_eff delta) xi, G* = Y/(4 (2
/// - nu) (1 + nu)) for two bodies of one material, with a Coulomb limit (Mindlin 1949; Mindlin & Deresiewicz
/// 1953 without partial slip).

#include <cmath>
#include <numbers>
#include <string_view>

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/parameters.hpp"
#include "sim/laws/tangential/dashpot.hpp"

namespace twincell::sim {

/// For Hertzian contacts ("hertz"), with which it shares its keys. The stiffness depends only on the present
/// overlap, not on the history of the normal load: unloading at constant xi lowers the force without work, so
/// a closed loading cycle may gain energy. If the force exceeds the limit mu |F_n|, the spring is shortened
/// so that it gives exactly the limit. There is no dashpot.
struct MindlinSlider {
  static constexpr std::string_view kWord = "mindlin", kName = "Mindlin spring with history, Coulomb limit";
  static constexpr std::string_view kHelp =
      "no dashpot, stiffness from the overlap (Hertz–Mindlin), without memory of the normal "
      "load";
  static constexpr const char* kKeys[] = {"mu", "youngs_modulus", "poisson_ratio"};
  static constexpr int kConstants = 2;
  static constexpr bool kActs = true, kHistory = true, kReadsOverlap = true;
  static constexpr std::string_view kWithoutHistory = DashpotSlider::kWord;

  double youngs_modulus = 0;  ///< Y, m g/sigma^2
  double poisson_ratio = 0;   ///< nu, 0 .. 0.5
  double mu = 0.6;

  static MindlinSlider read(const ContactTable& t) {
    return {t.required("youngs_modulus", 0, 1e15, true), t.number("poisson_ratio", 0, 0.5).value_or(0.3),
            read_friction(t)};
  }
  /// 8 G* sqrt(R_eff); multiplied by sqrt(delta) it is the stiffness.
  [[nodiscard]] double stiffness(double r_eff) const {
    return 2 * youngs_modulus * std::sqrt(r_eff) / ((2 - poisson_ratio) * (1 + poisson_ratio));
  }
  /// Without an overlap the law sets no limit on the step. With Hertz's law, whose contact time sets the
  /// step, the tangential oscillation is faster than the normal one by sqrt(2 (1 - nu)/(2 - nu) m_eff/m_t),
  /// at most 1.73 for discs and 1.87 for spheres: the step resolves both.
  [[nodiscard]] double shortest_time(const PairScale& /*p*/) const { return HUGE_VAL; }
  /// Half a period of the spring at an overlap, t0.
  [[nodiscard]] double shortest_time(const PairScale& p, double overlap) const {
    const double k_t = stiffness(p.r_eff) * std::sqrt(overlap);
    return k_t > 0 ? std::numbers::pi / std::sqrt(k_t * p.inv_m_t) : HUGE_VAL;
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {-stiffness(p.r_eff), mu};
  }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V dt, X& xi, V overlap) {
    xi = fma(dt, v_t, xi);
    const V k = c[0] * sqrt(max(overlap, V(0.0)));  // negative, as in the formula
    const auto [force, slips] = limited(k * xi, c[1] * abs(f_n));
    const V back = V(1.0) / min(k, V(-kTiny));
    xi = select(slips, back * force, xi);
    return force;
  }
};

}  // namespace twincell::sim
