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

}  // namespace twincell::sim
