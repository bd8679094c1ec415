#pragma once
/// \file
/// The cores of this machine at work on a sweep, a point on each.

#include <vector>

#include "sweep/schedule.hpp"

namespace twincell::sweep {

/// Told how things stand, several times a second, by the thread that called.
class Watch {
 public:
  virtual ~Watch() = default;
  /// \param seconds_left by the speed so far; NaN when nothing is known yet. May throw Interrupted
  virtual void look(const Counts& /*counts*/, double /*seconds_left*/) {}
  /// Seconds that are left to this call; points that would take longer are not begun.
  [[nodiscard]] virtual double time_left() const { return 1e300; }
};

struct FarmOptions {
  int threads = 1;
  bool keep_trajectories = false;
};

/// Computes what schedules ask for until all is done, or nothing fits into the time that is left. Where
/// points are at work in other processes it waits for them. \returns whether all is done \throws Interrupted,
/// NotStored, InputError, ConfigError
bool run_here(const std::vector<Schedule*>& schedules, const Store& store, const FarmOptions& options,
              Watch& watch);

}  // namespace twincell::sweep
