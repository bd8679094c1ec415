#pragma once
/// \file
/// The third reading of "truncate": the force is cut to the Coulomb limit, the spring goes on to stretch.

#include "sim/laws/tangential/spring.hpp"

namespace twincell::sim {

/// Equal to SpringOnlySlider while surfaces slide one way; a contact whose surfaces turn back slides on until
/// its spring has come back as far as it was stretched beyond the limit.
struct ForceClippedSlider : SpringSlider {
  static constexpr std::string_view kWord = "force-clipped",
                                    kName = "spring with history, dashpot, limit on the force alone";

  static ForceClippedSlider read(const ContactTable& t) { return {SpringSlider::read(t)}; }

  template <class V, class T, class X>
  static T force(const V* c, const T& v_t, V f_n, V dt, X& xi) {
    xi = fma(dt, v_t, xi);
    return limited(fma(c[0], xi, c[1] * v_t), c[2] * abs(f_n)).value;
  }
};

}  // namespace twincell::sim
