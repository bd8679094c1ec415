#pragma once
/// \file
/// Computes the points of sweeps on the cores of this machine, one point per core.

#include <string>
#include <vector>

#include "core/machine_memory.hpp"
#include "core/stage_times.hpp"
#include "sim/run/make_solver.hpp"
#include "sweep/schedule.hpp"

namespace twincell::sweep {

/// Callbacks of a running sweep.
class Watch {
 public:
  virtual ~Watch() = default;
  /// Receives what announce() expects, before the first point.
  /// \param seconds at most, elapsed, on all threads
  virtual void expect(const Counts& /*counts*/, double /*seconds*/) {}
  /// Receives the progress several times a second, in the calling thread. May throw Interrupted.
  /// \param seconds_left estimate from the speed so far, at most, as a search may end earlier; NaN until the
  ///     first point is done
  virtual void look(const Counts& /*counts*/, double /*seconds_left*/) {}
  /// A remaining time of this length, s, or longer is no limit.
  static constexpr double kNoTimeLimit = 1e200;
  /// Remaining time in seconds; points that would take longer are not started.
  [[nodiscard]] virtual double time_left() const { return kNoTimeLimit; }
  /// Receives, when run_here ends, the processor time of all results of its schedules, those of earlier calls
  /// included, in seconds; NaN if a result does not state it.
  virtual void cost(double /*processor_seconds*/) {}
};

/// Options of run_here.
struct FarmOptions {
  int threads = 1;
  bool keep_trajectories = false;
  /// Receives the times of the stages of run_point, "storing" and "waiting for points", summed over the
  /// threads; null: not timed.
  std::vector<StageTimes::Row>* times = nullptr;
  sim::SolverKind solver = sim::SolverKind::best;
};

/// Checks that the open points with the largest memory demand can run at once. The points of later rounds of
/// a search, which are not known yet, are counted with the larger demand of the two ends of the search range.
/// \param together number of points that run at once on this machine
/// \param way option that sets this number, for the message
/// \param available memory of the machine, bytes
/// \throws ConfigError naming `way`, or the key of the number of beads if a single point needs too much
void require_memory_together(const Schedule& schedule, int together, const std::string& way,
                             double available = memory_available());

/// Tells the watch how much the open points of the schedules cost, if that is more than 10^10 particle-steps,
/// some minutes of a core. The speed is that of the longest open point, measured here (sim/run/cost.hpp).
/// \throws Interrupted
void announce(const std::vector<Schedule*>& schedules, const FarmOptions& options, Watch& watch);

/// Computes the points of the schedules until all are done or no remaining point fits into the time left.
/// Once a point is done, those that exceed the time limit by more than 5 s and 5 % of the time are ended and
/// stay open. Without a time limit it waits for points that other processes compute.
/// \returns whether all points are done
/// \throws Interrupted, NotStored, InputError, ConfigError
bool run_here(const std::vector<Schedule*>& schedules, const Store& store, const FarmOptions& options,
              Watch& watch);

}  // namespace twincell::sweep
