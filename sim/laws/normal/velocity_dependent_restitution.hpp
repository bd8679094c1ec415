#pragma once
/// \file
/// Linear spring with a dashpot that is set at the start of each collision, so that the restitution decreases
/// with the impact speed: e(v) = max(e_0, 1 - (1 - e_0) (v/v_0)^(3/4)) (Bizon et al., Phys. Rev. Lett. 80,
/// 57, 1998). Bhateja et al. 2016 name the absence of such a law as a cause of their deviations from
/// experiments.

#include <cmath>
#include <string_view>

#include "sim/laws/linear_collision.hpp"
#include "sim/laws/scalar_arithmetic.hpp"

namespace twincell::sim {

/// Each contact remembers one number: its damping, fixed at first touch.
struct VelocityDependentRestitution {
  static constexpr std::string_view kWord = "velocity-dependent-restitution",
                                    kName = "linear spring, restitution falling with speed";
  static constexpr std::string_view kHelp = "linear, e decreases with the impact speed";
  static constexpr const char* kKeys[] = {"k_n", "restitution_fast", "restitution_speed"};
  static constexpr int kConstants = 4, kMemory = 1;

  double k_n = 1e6;               ///< m g/sigma
  double restitution_fast = 0.7;  ///< e_0, for impacts at v_0 and faster
  double restitution_speed = 1;   ///< v_0, sqrt(g sigma)

  static VelocityDependentRestitution read(const ContactTable& t) {
    return {read_stiffness(t), t.number("restitution_fast", 0, 1, true).value_or(0.7),
            t.number("restitution_speed", 0, 1e6, true).value_or(1)};
  }
  [[nodiscard]] static double restitution(double fast, double scale, double v) {
    return std::max(fast, 1 - (1 - fast) * std::pow(v / scale, 0.75));
  }
  [[nodiscard]] double shortest_time(const PairScale& p, double /*speed*/) const {
    const double eta = damping_of_restitution(restitution_fast) * std::sqrt(k_n * p.m_eff);
    return LinearCollision(k_n, eta, p.m_eff).shortest_time();
  }
  [[nodiscard]] double largest_force(double overlap) const { return k_n * overlap; }
  [[nodiscard]] bool is_elastic() const { return restitution_fast == 1; }
  [[nodiscard]] double impact_overlap(const PairScale& p, double speed) const {
    return speed * std::sqrt(p.m_eff / k_n);
  }
  [[nodiscard]] std::array<double, kConstants> constants(const PairScale& p) const {
    return {k_n, std::sqrt(k_n * p.m_eff), restitution_fast, 1 / restitution_speed};
  }

  template <class V>
  static V force(const V* c, V overlap, V v_n, V* memory) {
    const auto first = both(memory[0] == V(0.0), overlap > V(0.0));
    if (any(first)) {
      // (v/v_0)^(3/4) is computed with two square roots. The logarithm has no vector form; it runs lane by
      // lane, once per collision. The lower bound kTiny distinguishes an undamped contact (e = 1) from a new
      // one, whose memory is 0.
      const V u = sqrt(max(-v_n, V(0.0)) * c[3]);
      const V e = max(c[2], fma(c[2] - V(1.0), u * sqrt(u), V(1.0)));
      memory[0] =
          each(first, e, memory[0], [](double x) { return std::max(damping_of_restitution(x), kTiny); });
    }
    return nfma(memory[0] * c[1], v_n, c[0] * overlap);
  }
};

}  // namespace twincell::sim
