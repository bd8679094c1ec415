#pragma once
/// \file
/// The other reading of "truncate": the spring alone is held at the Coulomb limit, the dashpot dropped while
/// sliding.

#include "sim/laws/tangential/spring.hpp"

namespace twincell::sim {

/// A different law from SpringSlider: single collisions differ by per cents.
struct SpringOnlySlider : SpringSlider {
  static constexpr std::string_view kWord = "spring-limited",
                                    kName = "spring with history, dashpot, limit on the spring alone";

  static SpringOnlySlider read(const ContactTable& t) { return {SpringSlider::read(t)}; }

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
