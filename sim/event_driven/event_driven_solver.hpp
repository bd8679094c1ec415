#pragma once
/// \file
/// Solver for dilute gases: beads fly freely from contact to contact, and only contacts are integrated.

#include <functional>
#include <memory>
#include <string>

#include "sim/stepping/guard.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Factories of solvers that advance beads by time steps. Both use the same plan and give the same bits.
struct SteppingSolvers {
  std::function<std::unique_ptr<Solver>()> all, few;  ///< for all beads; for a cluster
};

/// Event-driven motion, with time steps where three or more bodies are in contact.
///
/// Beads without contact follow their parabolas exactly. The instant of the next touch is the root of a
/// quadratic (two beads, which have the same acceleration) or of a parabola minus a sine (bead and wall). A
/// contact of two bodies is integrated to a relative 1e-7 (binary_collision.hpp), whatever the time step. If
/// a third body may touch a bead that is in contact, these beads form a cluster, which is advanced separately
/// by time steps from the preceding whole step until its beads have parted (cluster.hpp). If a cluster has
/// more than eight members or does not part, all beads are advanced by time steps until each has at most one
/// contact. No contact is missed or simplified, and the time step matters only where three bodies meet.
std::unique_ptr<Solver> make_event_driven_solver(const Plan& plan, const GuardLimits& limits,
                                                 SteppingSolvers steps);

}  // namespace twincell::sim
