#pragma once
/// \file
/// How far a sweep is, on stderr.

#include <chrono>
#include <string>

#include "cli/output.hpp"
#include "sweep/farm.hpp"

namespace twincell::cli {

/// A time as people say it: "40 s", "12 min", "3.5 h".
std::string time_text(double seconds);

/// "12 of 40 points done, 2 running, about 3 min left": a line that is written over on a terminal, a new one
/// for every tenth of the points elsewhere. Ends the sweep at a signal.
class SweepWatch : public sweep::Watch {
 public:
  /// \param seconds that the sweep may take from now on
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
  int last_tenth_ = -1;
};

}  // namespace twincell::cli
