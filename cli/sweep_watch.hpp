#pragma once
/// \file
/// Progress of a sweep, printed on stderr.

#include <chrono>
#include <optional>
#include <string>

#include "cli/output.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

/// Prints "12 of 40 points done, 2 running, about 3 min left", of a search "12 of at most 40 points done", on
/// a terminal in one line that is overwritten, elsewhere in one line a minute. Throws Interrupted after a
/// signal, which ends the sweep.
class SweepWatch : public sweep::Watch {
 public:
  /// \param seconds time limit of the sweep, from now on
  explicit SweepWatch(const Common& common, double seconds = 1e300);
  ~SweepWatch() override;
  /// Prints "at most 40 points, 4.1e+11 particle-steps: at most about 2 h".
  void expect(const sweep::Counts& counts, double seconds) override;
  void look(const sweep::Counts& counts, double seconds_left) override;
  [[nodiscard]] double time_left() const override;
  void cost(double processor_seconds) override { runs_ = runs_.value_or(0) + processor_seconds; }
  /// Processor time of the runs of all sweeps so far, s; NaN if one is unknown, nullopt without a sweep.
  [[nodiscard]] std::optional<double> runs_seconds() const { return runs_; }

 private:
  bool quiet_, terminal_;
  ProgressBar signals_;
  double seconds_;
  std::optional<double> runs_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::string last_;
  EveryMinute due_;
};

}  // namespace twincell::cli
