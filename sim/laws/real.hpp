#pragma once
/// \file
/// The operations in which laws are written, for one contact at a time (double, float). Vector kernels bring
/// their own for a pack of contacts, under the same names, so a law is written once. Every operation is
/// correctly rounded, and products that are added to are fused by name: one contact alone and eight in a
/// vector give the same bits.

#include <cmath>
#include <concepts>

namespace twincell::sim {

/// What is added to, or compared with, a divisor that may be 0.
inline constexpr double kTiny = 1e-300;

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

}  // namespace twincell::sim
