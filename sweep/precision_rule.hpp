#pragma once
/// \file
/// When a mean of a running bed is known as well as the scene asks.

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/statistics/statistics.hpp"
#include "sim/scene/scene.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sweep {

/// Follows the scene's `until.quantity` frame by frame and ends the run once half of its 95 % interval is at
/// most the larger of until.relative_error times the mean and until.absolute_error. The interval is that of
/// `analyze`: means of whole cycles, overlapping blocks (BlockAverage); five of five correlation times must
/// fit into the run. It is first looked at after 100 cycles and after forty flights of a bead thrown
/// at V_p into an open cell (2 V_p/g each), for in less a gas does not show how slowly its height fluctuates;
/// then each time the run has become a fifth longer, so that it is not ended at the first lucky look of many;
/// and at the cap.
class PrecisionRule {
 public:
  /// \pre scene.until \throws ConfigError naming the quantities there are
  PrecisionRule(const sim::Scene& scene, const TrajectoryInfo& info);
  /// Takes a frame of the run. \returns true at the last phase of a cycle when the error is reached
  bool reached(const Frame& frame);
  /// Whether it was at the last look.
  [[nodiscard]] bool is_reached() const { return reached_; }
  /// "T_z is known to 0.95 % after 1240 cycles, 1 % was asked, correlation time 7.3 cycles"; where the cap
  /// ended the run: "the cap of 400 cycles ended the run: T_z is known to 3.1 %, …".
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] bool narrow() const;

  sim::Precision asked_;
  std::int64_t cap_;
  std::vector<double> mass_;
  int phases_, dimension_;
  double v_p_;
  BlockAverage cycles_;
  double sum_ = 0;
  std::int64_t next_look_;
  bool reached_ = false;
};

/// What `until.quantity` may be: T_x, T_y, T_z, T, T_g, T_bar_z, T_bar, h_cm, as `analyze` defines them.
const std::vector<std::string>& precision_quantities();

}  // namespace twincell::sweep
