#pragma once
/// \file
/// The kernel that a plan asks for.

#include <memory>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

enum class SolverKind {
  best,    ///< what the plan asks for, with the widest vectors that this processor has
  scalar,  ///< one contact at a time
  avx2,    ///< \throws ConfigError where the processor lacks it
  avx512,
  all_pairs,  ///< the oracle: every pair at every step, nothing clever
};

/// The kernel of a plan.
/// \param threads for one system; 0: as many as its size is worth
std::unique_ptr<Solver> make_solver(const Plan& plan, const GuardLimits& limits,
                                    SolverKind kind = SolverKind::best, int threads = 1);

/// Whether this processor can run a kind.
bool available(SolverKind kind);

}  // namespace twincell::sim
