#pragma once
/// \file
/// The contact laws of a cell: those between beads, and those with each wall. A header of its own, so that a
/// change in a law compiles only what evaluates laws (scene/plan.hpp holds a pointer).

#include <vector>

#include "sim/laws/contact_laws.hpp"

namespace twincell::sim {

struct CellLaws {
  ContactLaws bead;                ///< between beads
  std::vector<ContactLaws> walls;  ///< of each wall, in the order of Plan::walls
};

}  // namespace twincell::sim
