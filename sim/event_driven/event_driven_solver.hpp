#pragma once
/// \file
/// The kernel of dilute gases: beads fly from contact to contact, and only contacts are integrated.

#include <functional>
#include <memory>
#include <string>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Makes kernels that move beads by steps, of the same plan, with the same bits.
struct SteppingSolvers {
  std::function<std::unique_ptr<Solver>()> all, few;  ///< few: for those that meet in threes
};

/// Flights, and steps where beads meet in threes.
///
/// Beads that touch nothing fly on parabolas, exactly; the moment of the next touch is the root of a
/// quadratic (two beads, which fall alike) or of a parabola less a sine (bead and wall). A contact of two
/// bodies is integrated to a relative 1e-7 (binary_collision.hpp), whatever the time step. When a third body
/// comes near one that is in contact, they are moved by steps by themselves, from the whole step before until
/// they have parted (cluster.hpp). Where more than eight meet, or some stay together, all beads are handed to
/// steps, and taken back when each has at most one contact. So no contact is missed, none is simplified, and
/// the time step acts only where three bodies meet.
std::unique_ptr<Solver> make_event_driven_solver(const Plan& plan, const GuardLimits& limits,
                                                 SteppingSolvers steps);

}  // namespace twincell::sim
