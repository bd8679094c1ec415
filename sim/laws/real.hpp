#pragma once
/// \file
/// The operations in which laws are written, for one contact at a time (double, float). Vector kernels bring
/// their own for a pack of contacts, under the same names, so a law is written once. Every operation is
/// correctly rounded, and products that are added to are fused by name: one contact alone and sixteen in a
/// vector give the same bits.

#include <cmath>
#include <concepts>

namespace twincell::sim {

/// As many numbers of double precision as V has numbers: what is added up over many steps is kept in them.
template <class V>
struct DoublesOf {
  using Type = V;
};
template <>
struct DoublesOf<float> {
  using Type = double;
};
template <class V>
using Doubles = typename DoublesOf<V>::Type;

/// What is added to, or compared with, a divisor that may be 0.
template <class V>
inline constexpr double kTiny = 1e-300;
template <>
inline constexpr double kTiny<float> = 1e-30;

template <std::floating_point R>
R fma(R a, R b, R c) {
  return std::fma(a, b, c);
}  ///< a b + c
template <std::floating_point R>
R nfma(R a, R b, R c) {
  return std::fma(-a, b, c);
}  ///< c - a b
// Of two equal numbers the second, as vector units do: -0 and 0 are equal.
template <std::floating_point R>
R min(R a, R b) {
  return a < b ? a : b;
}
template <std::floating_point R>
R max(R a, R b) {
  return a > b ? a : b;
}
template <std::floating_point R>
R abs(R a) {
  return std::abs(a);
}
template <std::floating_point R>
R sqrt(R a) {
  return std::sqrt(a);
}
/// a where true, b where not. Both are computed.
template <std::floating_point R>
R select(bool where, R a, R b) {
  return where ? a : b;
}
inline bool any(bool where) {
  return where;
}
inline bool both(bool a, bool b) {
  return a && b;
}
inline bool either(bool a, bool b) {
  return a || b;
}
/// f(x) of a function that has no vector form, where asked; y elsewhere.
template <std::floating_point R, class F>
R each(bool where, R x, R y, F f) {
  return where ? R(f(x)) : y;
}

/// 1/sqrt(x), full precision for x in 0.8 .. 1.1, finite for every x >= 0. The sqrt and the division of the
/// hardware are the slowest instructions of a contact, and vector units differ in their quick estimates; a
/// polynomial and one step of third order are fast and the same bits everywhere. Callers scale x so that
/// touching beads have x <= 1: the overlaps that a healthy run has lie above 0.8.
template <class V>
inline V inverse_sqrt_near_one(V x) {
  const V e = V(1.0) - x, e2 = e * e;
  // Of all polynomials of fourth degree the nearest to (1 - e)^(-1/2), 1.6e-6 of it (Remez); Halley's step
  // takes that to 1e-17. In pairs of terms, since a contact waits for it.
  V y = fma(V(0.50001110355131846), e, V(1.0000015335600868));
  y = fma(fma(V(0.35516373634072791), e2, fma(V(0.3123060746874187), e, V(0.37404445348065794))), e2, y);
  const V h = nfma(x * y, y, V(1.0));
  return fma(y * h, fma(V(0.375), h, V(0.5)), y);
}

/// Of u = 1 - (r/reach)^2, which a contact in single precision knows to all its digits, 1 - r/reach over u
/// and reach/r.
template <class V>
struct NearReach {
  V overlap_over_u;  ///< 1/(1 + sqrt(1 - u))
  V inverse;         ///< 1/sqrt(1 - u)
};
/// To 5e-8 and 1e-9 for u in 0 .. 0.2, overlaps of up to a tenth of reach, by the nearest polynomials of
/// fourth and sixth degree (Remez). Their last terms are even and positive: both stay positive for u < 0,
/// however far, where beads are apart.
template <class V>
inline NearReach<V> near_reach(V u) {
  const V u2 = u * u, u4 = u2 * u2;
  const V p = fma(fma(V(0.036615661676969232), u, V(0.062670203124323382)), u2,
                  fma(V(0.12499636535980313), u, V(0.5000000004827926)));
  const V q = fma(fma(V(0.31186913121203735), u, V(0.3750184232795868)), u2,
                  fma(V(0.49999985245847264), u, V(0.9999999995318971)));
  const V end = fma(V(0.44939277280618084), u2, fma(V(0.17819595794530035), u, V(0.28283999237112606)));
  return {fma(V(0.040633423168684757), u4, p), fma(end, u4, q)};
}

}  // namespace twincell::sim
