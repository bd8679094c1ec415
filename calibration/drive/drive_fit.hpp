#pragma once
/// \file
/// The drive from the plate's heights frame by frame: amplitude, period, phase, and which frames do not
/// follow.
///
///     z(t) = z0 + A sin(theta) + A (h_s sin 2 theta + h_c cos 2 theta),   theta = omega t + phi
///
/// with t in frame intervals. No trigger is needed: the period is sought in a periodogram, then everything is
/// fitted together, first with Cauchy's loss, which outliers of any size cannot pull, then by least squares
/// to what lies within four standard deviations.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"

namespace twincell {

enum class FrameLock : std::uint8_t {
  locked,       ///< follows the fit
  out_of_lock,  ///< its height is off by more than four standard deviations
  unseen,       ///< no plate was seen
};

/// One frame.
struct LockedFrame {
  double tick = 0;      ///< its place in time, frame intervals; whole numbers that skip dropped frames
  double cycles = 0;    ///< cycles of the drive since phase 0 of the first cycle
  double residual = 0;  ///< height minus fit; NaN if unseen
  FrameLock lock = FrameLock::unseen;
};

struct DriveFitOptions {
  int frames_per_cycle = 0;  ///< N_k if known: where the search begins; 0: sought
  bool mend = true;          ///< look for dropped and doubled frames where the heights ask for it
  /// What the heights may be off by in a way that comes back every cycle, at the drive's own frequency too:
  /// it enters the errors of z0, A, omega, the phase and the second harmonic.
  double model_error = 0;
};

/// What the heights say. Lengths in the unit of the heights.
struct DriveFit {
  FitReport
      fit;  ///< "z0", "A", "phi" (at the first frame), "omega" and, where the phases tell it, "h_s", "h_c"
  double z0 = 0, amplitude = 0;
  double omega = 0;  ///< rad per frame interval
  double phi = 0;    ///< rad, at the first frame, in (-pi, pi]
  double phi_error = 0, omega_error = 0, amplitude_error = 0, z0_error = 0;
  double period = 0, period_error = 0;                           ///< frames
  std::optional<double> second_harmonic, second_harmonic_error;  ///< over A
  std::optional<double> p_sinusoidal;  ///< probability of a second harmonic this large by chance
  double rms = 0;                      ///< residual of the locked frames
  /// By how much more the residuals come back every cycle than noise would, at the third and higher
  /// harmonics; 1: not more. It enters the squared errors of z0, A, phi and the second harmonic.
  double cyclic_factor = 1;
  /// N_k, if the frames keep their phases to a quarter of a frame over the whole stack; else 0.
  int frames_per_cycle = 0;
  int first_phase = 0;      ///< of the first frame, in 0 .. N_k - 1
  double phase_offset = 0;  ///< frames by which the frames are later than their phases, in (-0.5, 0.5]
  double phase_offset_error = 0;
  std::optional<double>
      jitter;  ///< rms error of the moments, frame intervals; absent: less than jitter_limit
  double jitter_error = 0, jitter_limit = 0;  ///< standard error; 95 % upper limit
  std::int64_t locked = 0, out_of_lock = 0, unseen = 0, dropped = 0, doubled = 0;
  std::vector<LockedFrame> frames;
  std::vector<std::string> notes;
};

/// \param heights frame by frame, NaN where none was seen
/// \throws InputError for fewer than 8 heights, or heights that do not change by more than their scatter
DriveFit fit_drive(const std::vector<double>& heights, const DriveFitOptions& options = {});

}  // namespace twincell
