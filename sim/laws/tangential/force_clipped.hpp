#pragma once
/// \file
/// Third reading of "truncate": only the force is truncated to the Coulomb limit, and the spring continues to
/// stretch.

#include "sim/laws/coulomb_limit.hpp"
#include "sim/laws/tangential/spring.hpp"

namespace twincell::sim {

/// Equal to SpringLimitedSlider while the surfaces slide in one direction. After a reversal the contact
/// continues to slide until the spring has shortened by the amount that it was stretched beyond the limit.
struct ForceClippedSlider : SpringSlider {
  static constexpr std::string_view kWord = "force-clipped",
                                    kName = "spring with history, dashpot, limit on the force alone";
  static constexpr std::string_view kHelp =
      "the limit applies to the force and the spring continues to stretch";
  static constexpr SlipReading kReading = SlipReading::clip;

  static ForceClippedSlider read(const ContactTable& t) { return {SpringSlider::read(t)}; }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V dt, X& xi) {
    xi = fma(dt, v_t, xi);
    return limited(fma(c[0], xi, c[1] * v_t), c[2] * abs(f_n)).value;
  }
};

}  // namespace twincell::sim
