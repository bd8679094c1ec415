#pragma once
/// \file
/// Cost of a scene on this machine, measured on a short piece of the run.

#include <cstdint>
#include <optional>
#include <string>

#include "core/progress.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/plan.hpp"
#include "sim/start/start_speeds.hpp"

namespace twincell::sim {

struct Cost {
  Plan plan;  ///< for the beads of the start
  std::size_t beads = 0;
  std::optional<StartSpeeds> start_speeds;  ///< of the beads of the start
  std::string solver;                       ///< Solver::description()
  double bytes_per_bead = 0;                ///< memory in use for beads
  double bytes_per_pair = 0;  ///< memory in use, per listed pair or wall contact; 0 without listed contacts
  double pairs_per_bead = 0;  ///< listed contacts per bead
  std::int64_t measured_steps = 0;
  double seconds_per_step = 0;
  /// Work relative to the bed at rest (driven_work.hpp), by which the measured time of the bed at rest was
  /// multiplied; absent if a whole period was measured, or the beads are not a bed under gravity.
  std::optional<double> relative_work;
  double settled_for = 0;  ///< duration of settling before the measurement, t0
  std::string stopped;     ///< reason if the piece ended early, otherwise empty
};

/// Places the beads, lets them settle for at most 0.1 s, then drives them for `seconds`, in calls of the
/// length that a run uses. If this is less than a period, the bed at rest is stepped until the floor has
/// compressed it, for at most 8 `seconds`, and measured for another `seconds`; seconds_per_step is that time
/// multiplied by driven_work(). Times are processor time with one thread, and elapsed time with several.
/// \param threads as in make_solver
/// \throws ConfigError, InputError, exceptions of `progress`
Cost measure_cost(const Scene& scene, double seconds, int threads, Progress& progress = Progress::none());

}  // namespace twincell::sim
