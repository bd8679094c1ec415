#pragma once
/// \file
/// Selection of the solver for a plan.

#include <memory>
#include <string>

#include "sim/stepping/guard.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

enum class SolverKind {
  best,    ///< as the plan requires, with the widest SIMD of this processor
  scalar,  ///< one contact at a time
  avx2,    ///< \throws ConfigError if the processor does not support it
  avx512,
  all_pairs,  ///< the oracle: tests every pair at every step
  /// The solver for beds on a graphics card (device/device_solver.hpp), which shares launches with the other
  /// solvers of its kind in this process.
  /// \throws ConfigError if there is no card or no kernel for the plan
  gpu,
  device_on_host,  ///< the same, with the kernel compiled for the processor
};

/// Makes the solver of a plan.
/// \param threads for one system; 0: chosen from the number of beads
std::unique_ptr<Solver> make_solver(const Plan& plan, const GuardLimits& limits,
                                    SolverKind kind = SolverKind::best, int threads = 1);

/// The graphics card that SolverKind::gpu uses.
/// \throws ConfigError if there is none
std::string graphics_card();

/// Whether this processor supports a kind.
bool available(SolverKind kind);

}  // namespace twincell::sim
