#pragma once
/// \file
/// The solver of one bed on a device. Many of them, each in a thread of its own, share launches.

#include <memory>

#include "sim/device/batcher.hpp"
#include "sim/stepping/guard.hpp"
#include "sim/stepping/solver.hpp"

namespace twincell::sim {

/// Creates the solver. It has the bits of all other solvers that do time steps. The bed stays in the memory
/// of the device; a call transfers the beads, and the contact memory only where contacts() needs it.
/// \param batcher is used until the solver is destroyed
/// \throws ConfigError for laws without a device kernel, and for event-driven motion
std::unique_ptr<Solver> make_device_solver(const Plan& plan, const GuardLimits& limits, Batcher& batcher);

}  // namespace twincell::sim
