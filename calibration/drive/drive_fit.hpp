#pragma once
/// \file
/// Drive parameters from the plate's height in each frame: amplitude, period and phase, and the frames that
/// do not follow the motion.
///
///     z(t) = z0 + A sin(theta) + A (h_s sin 2 theta + h_c cos 2 theta),   theta = omega t + phi
///
/// with t in frame intervals. No trigger signal is needed. A periodogram gives the period; then all
/// parameters are fitted together, first with Cauchy's loss, which limits the influence of outliers of any
/// size, then by least squares to the heights within four standard deviations.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/fit.hpp"
#include "imaging/phase/out_of_lock.hpp"

namespace twincell::calibration {

/// How a frame relates to the fitted motion.
enum class FrameLock : std::uint8_t {
  locked,       ///< follows the fit
  out_of_lock,  ///< its height is off by more than four standard deviations
  unseen,       ///< the plate was not detected
};

/// Phase lock of one frame.
struct LockedFrame {
  double tick = 0;      ///< time in frame intervals; whole numbers that skip dropped frames
  double cycles = 0;    ///< cycles of the drive since phase 0 of the first cycle
  double residual = 0;  ///< height minus fit; NaN if unseen
  FrameLock lock = FrameLock::unseen;
};

/// Options of fit_drive.
struct DriveFitOptions {
  int frames_per_cycle = 0;  ///< N_k if known: start of the search; 0: from the periodogram
  bool mend = true;          ///< search for dropped and doubled frames if the heights indicate them
  /// Systematic error of the heights that recurs every cycle, also at the drive frequency. It enters the
  /// errors of z0, A, omega, the phase and the second harmonic.
  double model_error = 0;
  /// [frames] as imaging::RepeatedFrames::repeats; empty: none. The fit leaves repeated frames out; they
  /// count as doubled and take the phases of the frames before them, and a note names them.
  std::vector<std::uint8_t> repeats = {};
};

/// Result of fit_drive. Lengths are in the unit of the heights.
struct DriveFit {
  FitReport fit;  ///< "z0", "A", "phi" (at mid-stack), "omega"; "h_s", "h_c" if the phases determine them
  double z0 = 0, amplitude = 0;
  double omega = 0;  ///< rad per frame interval
  double phi = 0;    ///< rad, at the first frame, in (-pi, pi]
  double phi_error = 0, omega_error = 0, amplitude_error = 0, z0_error = 0;
  double period = 0, period_error = 0;                           ///< frames
  std::optional<double> second_harmonic, second_harmonic_error;  ///< over A
  std::optional<double> second_harmonic_phase;                   ///< Harmonic::phase
  std::optional<double> p_sinusoidal;  ///< probability of a second harmonic this large by chance
  double rms = 0;                      ///< residual of the locked frames
  /// Factor by which the power of the residuals at the third and higher harmonics exceeds that of white
  /// noise; at least 1. It enters the squared errors of z0, A, phi and the second harmonic.
  double cyclic_factor = 1;
  /// N_k if the phases drift by less than a quarter of a frame over the whole stack; else 0.
  int frames_per_cycle = 0;
  int first_phase = 0;      ///< of the first frame, in 0 .. N_k - 1
  double phase_offset = 0;  ///< delay of the frames after their nominal phases, in frames, (-0.5, 0.5]
  double phase_offset_error = 0;
  /// rms jitter of the exposure times, frame intervals; absent if below jitter_limit.
  std::optional<double> jitter;
  double jitter_error = 0, jitter_limit = 0;  ///< standard error; 95 % upper limit
  std::int64_t locked = 0, out_of_lock = 0, unseen = 0, dropped = 0, doubled = 0;
  std::vector<LockedFrame> frames;
  /// Where the plate does not follow the fit: before the shaker starts, after it stops, in a pause
  std::vector<imaging::FrameStretch> out_of_lock_stretches;
  std::vector<std::string> notes;

  /// Whether a frame has a phase: it is in no stretch out of lock. A single height that is misread does not
  /// take the phase of its frame away.
  [[nodiscard]] bool has_phase(std::size_t frame) const;
};

/// Fits the drive to the plate's heights.
/// \param heights one per frame, NaN where the plate was not detected
/// \throws InputError for fewer than 8 heights, or heights that do not change by more than their scatter
DriveFit fit_drive(const std::vector<double>& heights, const DriveFitOptions& options = {});

}  // namespace twincell::calibration
