#pragma once
/// \file
/// Which laws let one isolated collision be integrated by itself.

#include <concepts>

#include "sim/laws/concepts.hpp"

namespace twincell::sim {

/// A normal force that attracts while surfaces touch: a contact may last for ever, and F_n may rise through
/// 0.
template <class N>
concept Attracts = requires {
  requires N::kAttracts;
};

/// One formula for all overlaps and velocities, without memory, which repels at first touch.
template <class N>
concept SmoothNormal = N::kMemory == 0 && !Attracts<N> && requires {
  N::kSmooth;
};

/// No history, and a Coulomb limit that says where it binds.
template <class T>
concept PresentTangential = !T::kActs || (!T::kHistory && requires(const double* c, double x) {
  { T::slack(c, x, x) } -> std::same_as<double>;
});

/// A normal force without memory that repels at first touch, next to a tangential spring of constant
/// stiffness that has one.
template <class N, class T>
inline constexpr bool kRemembers =
    N::kMemory == 0 && !Attracts<N> && T::kActs && T::kHistory && !ReadsOverlap<T>;

}  // namespace twincell::sim
