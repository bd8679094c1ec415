#pragma once
/// \file
/// Early stop of a run whose answer is decided before its last cycle.

#include <cstdint>
#include <string>

#include "sweep/plan.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Decides the criterion of a search while the bed runs. Analyses the tracers every tenth cycle from the
/// twentieth on, with s_b and s_j as in the analysis.
///
/// convecting, yes: decided once the sum of s_j^2 exceeds N_f times the squared threshold, independent of the
/// remaining cycles (s_c^2 is the mean of s_j^2 over N_f cycles, Fortini & Huang 2015, eq. B2). convecting,
/// no: decided once half of the cycles are done and a high extrapolation to cycle N_f keeps s_c below a
/// quarter of the threshold. The extrapolation starts from the maximum of the later half of s_j^2 and rises
/// with the slope of its straight line plus three standard errors. bouncing: decided once the 95 % interval
/// of s_b is separated from the threshold by a tenth of it at two consecutive checks.
class StopRule {
 public:
  /// \param info metadata of the run
  /// \param cycles N_f
  StopRule(Criterion criterion, const TrajectoryInfo& info, std::int64_t cycles);
  /// Adds the next frame of the run.
  /// \returns whether the criterion is decided; true only at the last phase of a cycle
  bool add_frame(const Frame& frame);
  /// Why the criterion is decided, in a sentence; empty before.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  /// Decides from the frames so far, if they suffice.
  void decide();

  Criterion criterion_;
  std::int64_t cycles_;
  std::vector<std::size_t> slots_;
  MemoryTrajectory tracers_;  ///< the positions of the tracers only, to save memory
  int clear_ = 0;  ///< number of consecutive analyses in which s_b was separated from the threshold
  std::string reason_;
};

}  // namespace twincell::sweep
