#pragma once
/// \file
/// One list per axis of physics: the only place where the names of laws meet. To add a law: a struct in its
/// axis file that satisfies the axis's concept, its word in the list here, a branch in plan.cpp that says
/// when a scene calls for it, and a verification test. The products are made by the compiler in
/// kernel_2d.cpp.

#include <variant>

#include "sim/laws/concepts.hpp"
#include "sim/laws/normal.hpp"
#include "sim/laws/side.hpp"
#include "sim/laws/tangential.hpp"

namespace twincell::sim {

using NormalAxis = std::variant<LinearSpringDashpot, ClippedSpringDashpot>;
using TangentialAxis = std::variant<NoTangential, DashpotSlider, SpringSlider, SpringOnlySlider>;
using SideAxis = std::variant<SideWalls, PeriodicSides>;

/// One law per axis, with its parameters for bead-bead and for bead-wall contacts.
template <NormalLaw N, TangentialLaw T, SideLaw S>
struct LawSet {
  using Tangential = T;
  using Side = S;
  struct Contact {
    N normal;
    T tangential;
  };
  Contact bead, wall;
  S side;
};

}  // namespace twincell::sim
