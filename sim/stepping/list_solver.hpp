#pragma once
/// \file
/// The list solver, which uses a neighbour list and, within it, a list of the pairs that can touch soon; and
/// the all-pairs solver.

#include <memory>

#include "sim/kernels/kernels.hpp"
#include "sim/stepping/guard.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Creates the list solver, which keeps a list within a list (dual pair list, after Pall & Hess 2013).
///
/// The outer list contains every pair whose surfaces are closer than a skin. It remains valid until beads may
/// have crossed the skin. Displacements are measured relative to the mean motion, so a bed that rides on its
/// plate keeps its list for thousands of steps.
///
/// The inner list contains the pairs of the outer list that free flight at their present velocities brings
/// closer than twice a slack within some dozens of steps. Only these pairs are evaluated. The inner list
/// remains valid until contacts have deflected some bead from free flight by the slack, or until these steps
/// are over. Both bounds are strict: no contact is missed.
std::unique_ptr<Solver> make_list_solver(const Plan& plan, const GuardLimits& limits, const Target& target,
                                         int threads);

/// Creates the all-pairs solver, which evaluates every pair and every wall at every step: with kScalar the
/// oracle, with wider targets the solver for a few beads.
std::unique_ptr<Solver> make_all_pairs_solver(const Plan& plan, const GuardLimits& limits,
                                              const Target& target);

}  // namespace twincell::sim
