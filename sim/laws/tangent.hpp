#pragma once
/// \file
/// Vectors in the tangent plane of a contact: a signed number in 2D, a vector in 3D. Laws of friction and of
/// rolling are written once for both.

#include "sim/laws/scalar_arithmetic.hpp"

namespace twincell::sim {

/// K components of type V: K = 1 in 2D, 3 in 3D.
template <class V, int K>
struct Tangent {
  V c[K];
};

template <class V, int K>
inline Tangent<V, K> operator*(V a, const Tangent<V, K>& t) {
  Tangent<V, K> r;
  for (int k = 0; k < K; ++k) r.c[k] = a * t.c[k];
  return r;
}
/// a t + u
template <class V, int K>
inline Tangent<V, K> fma(V a, const Tangent<V, K>& t, const Tangent<V, K>& u) {
  Tangent<V, K> r;
  for (int k = 0; k < K; ++k) r.c[k] = fma(a, t.c[k], u.c[k]);
  return r;
}
template <class V, int K>
inline Tangent<V, K> operator+(const Tangent<V, K>& t, const Tangent<V, K>& u) {
  Tangent<V, K> r;
  for (int k = 0; k < K; ++k) r.c[k] = t.c[k] + u.c[k];
  return r;
}
template <class V, int K>
inline Tangent<V, K> operator-(const Tangent<V, K>& t, const Tangent<V, K>& u) {
  Tangent<V, K> r;
  for (int k = 0; k < K; ++k) r.c[k] = t.c[k] - u.c[k];
  return r;
}
template <class M, class V, int K>
inline Tangent<V, K> select(M where, const Tangent<V, K>& t, const Tangent<V, K>& u) {
  Tangent<V, K> r;
  for (int k = 0; k < K; ++k) r.c[k] = select(where, t.c[k], u.c[k]);
  return r;
}
template <class V, int K>
inline V norm(const Tangent<V, K>& t) {
  if constexpr (K == 1) {
    return abs(t.c[0]);
  } else {
    V s = t.c[0] * t.c[0];
    for (int k = 1; k < K; ++k) s = fma(t.c[k], t.c[k], s);
    return sqrt(s);
  }
}

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

}  // namespace twincell::sim
