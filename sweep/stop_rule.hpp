#pragma once
/// \file
/// When a run's verdict is settled before its last cycle.

#include <cstdint>
#include <string>

#include "sweep/plan.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Looks at the tracers of a running bed, every tenth cycle from the twentieth on, with the analysis' own s_b
/// and s_j.
///
/// convecting: yes, for certain, once the sum of s_j^2 exceeds N_f times the squared threshold, whatever the
/// cycles to come (s_c^2 is the mean of s_j^2 over N_f cycles, Fortini & Huang 2015, eq. B2). No, once the
/// straight line through the later half of s_j^2, raised and steepened by three standard errors of its slope,
/// keeps s_c below a quarter of the threshold up to cycle N_f. bouncing: once, at two looks in a row, the 95
/// % interval of s_b stays clear of the threshold by a tenth of it.
class StopRule {
 public:
  /// \param info of the run \param cycles N_f
  StopRule(Verdict verdict, const TrajectoryInfo& info, std::int64_t cycles);
  /// Takes a frame of the run. \returns true when the verdict is settled, at the last phase of a cycle
  bool settled(const Frame& frame);
  /// Why, in a sentence; empty as long as it is not.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  void look();

  Verdict verdict_;
  std::int64_t cycles_;
  std::vector<std::size_t> slots_;
  MemoryTrajectory tracers_;  ///< their positions alone: a twentieth of a bed
  int clear_ = 0;             ///< looks in a row at which s_b was clear of the threshold
  std::string reason_;
};

}  // namespace twincell::sweep
