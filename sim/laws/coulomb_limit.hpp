#pragma once
/// \file
/// The Coulomb limit: truncation of a tangential force, or of a torque against rolling, and the spring with
/// dashpot that is shortened where it would exceed the limit. Friction and rolling share both.

#include "sim/laws/scalar_arithmetic.hpp"
#include "sim/laws/tangent.hpp"

namespace twincell::sim {

/// A vector truncated to a maximum length, and a mask of where it was truncated.
template <class V, int K>
struct Limited {
  Tangent<V, K> value;
  decltype(V() > V()) cut;
};

/// Truncates t to length `limit` >= 0 and keeps its direction (or sign). A zero vector stays zero.
template <class V, int K>
inline Limited<V, K> limited(const Tangent<V, K>& t, V limit) {
  if constexpr (K == 1) {
    const auto cut = abs(t.c[0]) > limit;
    return {{{min(max(t.c[0], -limit), limit)}}, cut};
  } else {
    const V length = norm(t);
    const auto cut = length > limit;
    // Where t is truncated, length > limit >= 0. Elsewhere the quotient is not used, but it must be finite.
    const V factor = select(cut, limit / max(length, V(kTiny)), V(1.0));
    return {factor * t, cut};
  }
}

/// Advances a spring with dashpot by one step and returns its force -(k x + eta v), truncated to mu |F_n|. If
/// it is truncated, the spring is shortened so that spring and dashpot together give exactly the limit.
/// \param c {-k, -eta, mu, -1/k}: the signs are those of the formula
/// \param v velocity at which the spring is stretched
/// \param x stretch of the spring, which the contact remembers
template <class V, class T, class X>
[[gnu::always_inline]] inline T spring_slider(const V* c, const T& v, V f_n, V dt, X& x) {
  x = fma(dt, v, x);
  const T dashpot = c[1] * v;
  const auto [force, slips] = limited(fma(c[0], x, dashpot), c[2] * abs(f_n));
  x = select(slips, c[3] * (force - dashpot), x);
  return force;
}

}  // namespace twincell::sim
