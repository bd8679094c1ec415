#pragma once
/// \file
/// Amplitude of the drive from the motion of the bed: while the bed rests on the plate, its lowest beads move
/// with the plate.
///
/// Of the beads seen in two consecutive frames, the lowest bead of each column one sigma wide is taken; the
/// median of their displacements is the step of the bed's lower surface. At the phases at which a bed rests
/// on a plate of amplitude A,
///     steps z(t_{k+1}) - z(t_k) = a (sin th_{k+1} - sin th_k) + b (cos th_{k+1} - cos th_k),
/// with a and b from least squares for each cycle. b is 0 if the phases of the frames are correct, and serves
/// as a check. The phases depend on A: the whole cycle for Gamma <= 1. Above, they last from the landing of a
/// body that does not rebound, plus a tenth of a cycle for the motion that the impact excites, until its
/// take-off at sin th = 1/Gamma. The amplitude is the A for which the fit at these phases returns a = A.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/drive.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::calibration {

/// Interval, in fractions of a cycle, in which a body that does not rebound rests on the plate: from its
/// landing, negative if that was in the previous cycle, to its take-off. The whole cycle for Gamma <= 1; no
/// value if the flight lasts longer than a cycle (Gamma > 3.3).
struct TimeOnPlate {
  double from = 0, to = 1;
};
/// The interval for the acceleration Gamma = A omega^2/g of the plate.
std::optional<TimeOnPlate> time_on_plate(double gamma);
/// The same without the tenth of a cycle after a landing, during which the impact still moves the beads.
std::optional<TimeOnPlate> time_at_rest(double gamma);

/// Receives the frames of a trajectory and stores the steps of the bed's lower surface, about 40 bytes per
/// frame.
class BedSteps : public TrajectorySink {
 public:
  struct Step {
    std::int64_t cycle = 0;     ///< of the earlier frame
    std::int32_t phase = -1;    ///< of the earlier frame
    double begin = 0, end = 0;  ///< fractions of a cycle since phase 0 of that cycle
    double dz = 0;              ///< median over the beads, sigma
    double spread = 0;          ///< robust standard deviation among the beads, sigma
  };
  explicit BedSteps(const TrajectoryInfo& info) : info_(info) {}
  void append(const Frame& frame) override;
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }

 private:
  const TrajectoryInfo info_;
  Frame before_;
  std::vector<Step> steps_;
};

/// Amplitude of the drive as measured on the bed.
struct BedDrive {
  double amplitude = 0, amplitude_error = 0;  ///< sigma; standard error from the scatter between cycles
  std::size_t cycles = 0;                     ///< number of fitted cycles
  double from = 0, to = 1;                    ///< fitted interval, fractions of a cycle
  int phase_shift = 0;         ///< frames by which the bed is later in the cycle than its phases state
  std::string not_comparable;  ///< why the bed gives no amplitude; empty if it does
  std::string contradiction;   ///< clause: why no drive of this strength moves the bed so; otherwise empty
};

/// Fits the amplitude to the steps of the bed. Of several solutions it returns the one closest to the stated
/// amplitude. If the bed moves like a plate at no phase, the phases are shifted by whole frames; a shift is
/// accepted if it alone (or one of two neighbours) makes the bed move like a plate of the stated amplitude
/// within a tenth. A contradiction is a bed that stands still, that follows over the whole cycle a plate
/// which would throw it, or whose downward acceleration at some phase is more than 1.5 times the larger of
/// gravity and the plate's acceleration. \pre `info` states the drive
BedDrive drive_of_bed(const BedSteps& bed, const TrajectoryInfo& info);

/// What in the motion of a bed contradicts its drive, where the plate in the picture agrees with the
/// amplitude and the phases: it stands still; it falls faster than gravity, or by less than half of it where
/// Gamma > 1.3 throws it, or by more than 2 g for an eighth of a cycle; it leaves a plate with Gamma < 0.95;
/// or it follows a plate over the whole cycle that throws it, with less than half the departures of a bed
/// without rebound at Gamma/1.1. The last needs a single cycle of at least eight phases.
///
/// \pre the trajectory has a drive with gravity
/// \returns a clause; empty if nothing does, or if the drive is not a sine or the frames have no phases
std::string contradiction_of_bed(const BedSteps& bed, const TrajectoryInfo& info);

}  // namespace twincell::calibration
