#pragma once
/// \file
/// What a scene costs on this machine, found by running a little of it.

#include <cstdint>
#include <string>

#include "core/progress.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/plan.hpp"

namespace twincell::sim {

struct Cost {
  Plan plan;  ///< with the beads as they are
  std::size_t beads = 0;
  std::string kernel;         ///< Solver::description()
  double bytes_per_bead = 0;  ///< memory held, beads
  double bytes_per_pair = 0;  ///< memory held, per listed pair or wall contact; 0 if none was listed
  double pairs_per_bead = 0;  ///< listed
  std::int64_t measured_steps = 0;
  double seconds_per_step = 0;
  double settled_for = 0;  ///< t0 of settling before the measurement
  std::string stopped;     ///< why the piece ended early; empty: it did not
};

/// Places the beads, lets them settle for a tenth of a second of clock time, then drives them for `seconds`.
/// \param threads as in make_solver \throws ConfigError, InputError, what `progress` throws
Cost measure_cost(const Scene& scene, double seconds, int threads, Progress& progress = Progress::none());

}  // namespace twincell::sim
