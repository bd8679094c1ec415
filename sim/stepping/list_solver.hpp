#pragma once
/// \file
/// The fast kernel: a neighbour list, inside it a list of the pairs that can touch soon, and passes over
/// packets of those.

#include <memory>

#include "sim/kernels/kernels.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Two lists, one in the other (dual pair list, after Pall & Hess 2013). The outer one holds every pair whose
/// surfaces are closer than a skin; it lasts until beads may have crossed the skin, displacements taken
/// against the mean motion, so that a bed riding on its plate keeps it for thousands of steps. The inner one
/// holds the pairs of the outer one closer than a margin that beads at their present relative speed cannot
/// cross in some dozens of steps; only these are evaluated, and it lasts until the sum over steps of the
/// largest relative speed times dt exceeds the margin. Both bounds are strict: no contact is ever missed.
std::unique_ptr<Solver> make_list_solver(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads);

/// Every pair and every wall at every step: with kScalar the oracle, with wider ones for a few beads.
std::unique_ptr<Solver> make_all_pairs_solver(const Plan& plan, const GuardLimits& limits,
                                              const Target& target);

}  // namespace twincell::sim
