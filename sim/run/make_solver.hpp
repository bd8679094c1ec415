#pragma once
/// \file
/// Selection of the solver for a plan.

#include <memory>

#include "sim/stepping/solver.hpp"

namespace twincell::sim {

enum class SolverKind {
  best,    ///< as the plan requires, with the widest SIMD of this processor
  scalar,  ///< one contact at a time
  avx2,    ///< \throws ConfigError if the processor does not support it
  avx512,
  all_pairs,  ///< the oracle: tests every pair at every step
};

/// Makes the solver of a plan.
/// \param threads for one system; 0: chosen from the number of beads
std::unique_ptr<Solver> make_solver(const Plan& plan, const GuardLimits& limits,
                                    SolverKind kind = SolverKind::best, int threads = 1);

/// Whether this processor supports a kind.
bool available(SolverKind kind);

}  // namespace twincell::sim
