#pragma once
/// \file
/// The cores of this machine at work on a sweep, a point on each.

#include <string>
#include <vector>

#include "core/machine_memory.hpp"
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

/// Whether the open points that take most memory can run at once; later rounds of a search are counted with
/// the ends of its range. \param together how many run at once on this machine \param way option that says so
/// \param available bytes \throws ConfigError naming `way`, or the key of the beads where one point is too
/// much
void require_memory_together(const Schedule& schedule, int together, const std::string& way,
                             double available = memory_available());

/// Computes what schedules ask for until all is done, or nothing fits into the time that is left. Where
/// points are at work in other processes it waits for them. \returns whether all is done \throws Interrupted,
/// NotStored, InputError, ConfigError
bool run_here(const std::vector<Schedule*>& schedules, const Store& store, const FarmOptions& options,
              Watch& watch);

}  // namespace twincell::sweep
