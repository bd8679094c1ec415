#pragma once
/// \file
/// Second reading of "truncate": only the spring is limited to the Coulomb limit, and the dashpot is dropped
/// while the surfaces slide.

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/tangential/spring.hpp"

namespace twincell::sim {

/// This law differs from SpringSlider: the results of single collisions differ by per cents.
struct SpringLimitedSlider : SpringSlider {
  static constexpr std::string_view kWord = "spring-limited",
                                    kName = "spring with history, dashpot, limit on the spring alone";
  static constexpr std::string_view kHelp = "the limit applies to the spring and the dashpot is dropped";
  static constexpr SlipReading kReading = SlipReading::spring_limited;

  static SpringLimitedSlider read(const ContactTable& t) { return {SpringSlider::read(t)}; }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V dt, X& xi) {
    xi = fma(dt, v_t, xi);
    const V limit = c[2] * abs(f_n);
    const auto [spring, slips] = limited(c[0] * xi, limit);
    const T sticking = limited(fma(c[1], v_t, spring), limit).value;
    xi = select(slips, c[3] * spring, xi);
    return select(slips, spring, sticking);
  }
};

}  // namespace twincell::sim
