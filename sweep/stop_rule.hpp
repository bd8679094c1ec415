#pragma once
/// \file
/// Early stop of a run whose verdict is decided before its last cycle.

#include <cstdint>
#include <string>

#include "sweep/plan.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Analyses the tracers of a running bed every tenth cycle from the twentieth on, with s_b and s_j as in the
/// analysis.
///
/// convecting, yes: decided once the sum of s_j^2 exceeds N_f times the squared threshold, independent of the
/// remaining cycles (s_c^2 is the mean of s_j^2 over N_f cycles, Fortini & Huang 2015, eq. B2). convecting,
/// no: decided once half of the cycles are done and a high extrapolation to cycle N_f keeps s_c below a
/// quarter of the threshold. The extrapolation starts from the maximum of the later half of s_j^2 and rises
/// with the slope of its straight line plus three standard errors. bouncing: decided once the 95 % interval
/// of s_b is separated from the threshold by a tenth of it at two consecutive checks.
class StopRule {
 public:
  /// \param info metadata of the run \param cycles N_f
  StopRule(Verdict verdict, const TrajectoryInfo& info, std::int64_t cycles);
  /// Processes a frame of the run. \returns true when the verdict is decided, at the last phase of a cycle
  bool settled(const Frame& frame);
  /// Why the verdict is decided, in a sentence; empty before.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  void look();

  Verdict verdict_;
  std::int64_t cycles_;
  std::vector<std::size_t> slots_;
  MemoryTrajectory tracers_;  ///< only the positions of the tracers: a twentieth of a bed
  int clear_ = 0;             ///< consecutive checks at which s_b was separated from the threshold
  std::string reason_;
};

}  // namespace twincell::sweep
