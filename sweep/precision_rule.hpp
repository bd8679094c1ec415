#pragma once
/// \file
/// Stop criterion for a running simulation: a mean has reached the precision that the scene requires.

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"
#include "sim/scene/scene.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Follows the scene's `until.quantity` frame by frame. The run ends once half of the 95 % interval of its
/// mean is at most the larger of until.relative_error times the mean and until.absolute_error. The interval
/// is that of `analyze`: means of whole cycles as a correlated series (SeriesAverage); the run must hold
/// eight correlation times.
///
/// The first check is after 100 cycles and after forty flights of a bead thrown at V_p into an open cell (2
/// V_p/g each), because a shorter gas run does not show how slowly its height fluctuates. Further checks
/// follow each time the run has become a fifth longer, so that it does not end at the first favourable one of
/// many checks, and at the cycle limit (cap).
class PrecisionRule {
 public:
  /// \pre scene.until is set
  /// \throws ConfigError listing the valid quantities
  PrecisionRule(const sim::Scene& scene, const TrajectoryInfo& info);
  /// Processes a frame of the run.
  /// \returns true at the last phase of a cycle when the precision is reached
  bool reached(const Frame& frame);
  /// Whether the precision was reached at the last check.
  [[nodiscard]] bool is_reached() const { return reached_; }
  /// "T_z is known to 0.95 % after 1240 cycles; 1 % was asked; correlation time 7.3 cycles", or, if the cap
  /// ended the run, "the cap of 400 cycles ended the run: T_z is known to 3.1 %; …".
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] bool narrow() const;

  sim::Precision asked_;
  std::int64_t cap_;
  std::vector<double> mass_;
  int phases_, dimension_;
  double v_p_;
  analysis::SeriesAverage cycles_;
  double sum_ = 0;
  std::int64_t next_look_;
  bool reached_ = false;
};

/// Valid values of `until.quantity`: T_x, T_y, T_z, T, T_g, T_bar_z, T_bar, h_cm, as `analyze` defines them.
const std::vector<std::string>& precision_quantities();

}  // namespace twincell::sweep
