#pragma once
/// \file
/// The drive's amplitude from the bed: while it lies on the plate, its lowest beads move as the plate does.
///
/// Of the beads seen in two consecutive frames, the lowest of every column one sigma wide give, by their
/// median, the step of the bed's lower side. In the phases in which a bed lies on a plate of amplitude A,
///     steps z(t_{k+1}) - z(t_k) = a (sin th_{k+1} - sin th_k) + b (cos th_{k+1} - cos th_k),
/// a and b by least squares for each cycle; b, which is 0 where the frames' phases are right, is a check.
/// Those phases depend on A: all of the cycle for Gamma <= 1, else from the landing of a body that does not
/// rebound, and a tenth of a cycle for what the impact sets in motion, to its take-off at sin th = 1/Gamma.
/// The amplitude is the A whose phases give a = A back.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/drive.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Fractions of a cycle between which a body that does not rebound lies on the plate: from its landing, below
/// 0 where it landed in the cycle before, to its take-off. A whole cycle for Gamma <= 1; nothing if it flies
/// for longer than a cycle (Gamma > 3.3).
struct TimeOnPlate {
  double from = 0, to = 1;
};
std::optional<TimeOnPlate> time_on_plate(double gamma);

/// Takes a trajectory's frames and keeps the steps of the bed's lower side, some 40 bytes a frame.
class BedSteps : public TrajectorySink {
 public:
  struct Step {
    std::int64_t cycle = 0;     ///< of the earlier frame
    std::int32_t phase = -1;    ///< of the earlier frame
    double begin = 0, end = 0;  ///< fractions of a cycle since phase 0 of that cycle
    double dz = 0;              ///< median over the beads, sigma
  };
  explicit BedSteps(const TrajectoryInfo& info) : info_(info) {}
  void append(const Frame& frame) override;
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }

 private:
  const TrajectoryInfo info_;
  Frame before_;
  std::vector<Step> steps_;
};

/// The drive as the bed shows it.
struct BedDrive {
  double amplitude = 0, amplitude_error = 0;  ///< sigma; standard error by the scatter between cycles
  std::size_t cycles = 0;                     ///< that were fitted
  double from = 0, to = 1;                    ///< fractions of a cycle that were fitted
  std::string not_comparable;                 ///< why the bed does not show it; empty: it does
};

/// \pre the drive of `info` is known
BedDrive drive_of_bed(const BedSteps& bed, const TrajectoryInfo& info);

}  // namespace twincell
