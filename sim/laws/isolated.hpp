#pragma once
/// \file
/// Which laws let one isolated collision be integrated by itself.

#include <concepts>

#include "sim/laws/concepts.hpp"

namespace twincell::sim {

/// One formula for all overlaps and velocities, without memory.
template <class N>
concept SmoothNormal = N::kMemory == 0 && requires {
  N::kSmooth;
};

/// No history, and a Coulomb limit that says where it binds.
template <class T>
concept PresentTangential = !T::kActs || (!T::kHistory && requires(const double* c, double x) {
  { T::slack(c, x, x) } -> std::same_as<double>;
});

/// A normal force without memory next to a tangential spring of constant stiffness that has one.
template <class N, class T>
inline constexpr bool kRemembers = N::kMemory == 0 && T::kActs&& T::kHistory && !ReadsOverlap<T>;

}  // namespace twincell::sim
