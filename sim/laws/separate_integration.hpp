#pragma once
/// \file
/// Conditions on contact laws for the separate integration of one isolated binary collision.

#include <concepts>

#include "sim/laws/concepts.hpp"

namespace twincell::sim {

/// A normal force that attracts while the surfaces touch: a contact may last for ever, and F_n may rise
/// through 0.
template <class N>
concept Attracts = requires {
  requires N::kAttracts;
};

/// A normal force given by one formula for all overlaps and velocities, without memory, and repulsive at
/// first touch. Of a law that omits tension (concepts.hpp) the formula is that with tension.
template <class N>
concept SmoothNormal = N::kMemory == 0 && !Attracts<N> && requires {
  N::kSmooth;
};

/// The formula of a smooth normal force. Of a law that omits tension it is below 0 where the force is 0.
template <class N, class V>
[[gnu::always_inline]] inline V smooth_force(const V* c, V overlap, V v_n) {
  if constexpr (OmitsTension<N>)
    return N::template force_with_tension<V>(c, overlap, v_n, nullptr);
  else
    return N::template force<V>(c, overlap, v_n, nullptr);
}

/// A tangential law without history: either no force at all, or one that provides slack(), its distance to
/// the Coulomb limit.
template <class T>
concept PresentTangential = !T::kActs || (!T::kHistory && requires(const double* c, double x) {
  { T::slack(c, x, x) } -> std::same_as<double>;
});

/// True for a normal force without memory that repels at first touch, combined with a tangential spring that
/// has history and a stiffness independent of the overlap.
template <class N, class T>
inline constexpr bool kRemembers =
    N::kMemory == 0 && !Attracts<N> && T::kActs && T::kHistory && !ReadsOverlap<T>;

}  // namespace twincell::sim
