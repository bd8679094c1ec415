#pragma once
/// \file
/// Progress of a sweep, printed on stderr.

#include <chrono>
#include <string>

#include "cli/output.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

/// Prints "12 of 40 points done, 2 running, about 3 min left": on a terminal one line that is overwritten,
/// elsewhere one line a minute. Throws Interrupted after a signal, which ends the
/// sweep.
class SweepWatch : public sweep::Watch {
 public:
  /// \param seconds time limit of the sweep, from now on
  explicit SweepWatch(const Common& common, double seconds = 1e300);
  ~SweepWatch() override;
  void look(const sweep::Counts& counts, double seconds_left) override;
  [[nodiscard]] double time_left() const override;

 private:
  bool quiet_, terminal_;
  ProgressBar signals_;
  double seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::string last_;
  EveryMinute due_;
};

}  // namespace twincell::cli
