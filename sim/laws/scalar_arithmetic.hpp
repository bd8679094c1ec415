#pragma once
/// \file
/// The arithmetic operations that contact laws use, for one contact at a time (double, float). SIMD kernels
/// provide the same operations under the same names for a vector of contacts, so each law is written once.
/// Every operation is correctly rounded, and multiply-add is fused only where fma() or nfma() is called, so a
/// single contact and eight contacts in a vector give the same bits.

#include <cmath>
#include <concepts>

namespace twincell::sim {

/// Lower bound on the magnitude of a divisor that may be 0.
inline constexpr double kTiny = 1e-300;

template <std::floating_point R>
R fma(R a, R b, R c) {
  return std::fma(a, b, c);
}  ///< a b + c
template <std::floating_point R>
R nfma(R a, R b, R c) {
  return std::fma(-a, b, c);
}  ///< c - a b
// Of two equal numbers min and max return the second, as vector instructions do; -0 and 0 are equal.
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
/// Returns a where `where` is true, else b. Both are computed.
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
/// Returns f(x) where `where` is true, else y; for functions f without a vector form.
template <std::floating_point R, class F>
R each(bool where, R x, R y, F f) {
  return where ? R(f(x)) : y;
}

/// 1/sqrt(x), to full precision for x in 0.8 .. 1.1, and finite for x in 0 .. 1e14. The square root and the
/// division are the slowest instructions of a contact, and the fast estimates of different vector units
/// differ. A polynomial and one third-order step are fast and give the same bits everywhere. Callers scale x
/// so that touching beads have x <= 1; overlaps below a tenth of R_i + R_j give x above 0.8.
template <class V>
inline V inverse_sqrt_near_one(V x) {
  const V e = V(1.0) - x, e2 = e * e;
  // Minimax polynomial of degree 4 for (1 - e)^(-1/2), relative error 1.6e-6 (Remez). Halley's step reduces
  // the error to 1e-17, below the rounding. Terms are evaluated in pairs, because the rest of the contact
  // waits for the result.
  V y = fma(V(0.50001110355131846), e, V(1.0000015335600868));
  y = fma(fma(V(0.35516373634072791), e2, fma(V(0.3123060746874187), e, V(0.37404445348065794))), e2, y);
  const V h = nfma(x * y, y, V(1.0));
  return fma(y * h, fma(V(0.375), h, V(0.5)), y);
}

}  // namespace twincell::sim
