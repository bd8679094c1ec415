#pragma once
/// \file
/// The drive, a sine with optional harmonics or a recorded motion, and its dimensionless numbers. A ramp may
/// change it during the run, and it may have a horizontal component.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/error.hpp"
#include "trajectory/box.hpp"
#include "trajectory/drive_ramp.hpp"

namespace twincell {

class RecordedMotion;

/// Harmonic of order n of a drive: A a sin(n omega t + 2 pi phi), with A the amplitude of the first harmonic.
struct Harmonic {
  double amplitude = 0;  ///< a, relative to A, 0 <= a <= kLargestHarmonic
  double phase = 0;      ///< phi, cycles of this harmonic, 0 <= phi < 1
};

/// Largest number of harmonics above the first, and largest relative amplitude of one.
inline constexpr std::size_t kMaxHarmonics = 30;
inline constexpr double kLargestHarmonic = 100;

/// Motion of the plate along x beside that along z: x(t) = X sin(n omega t + 2 pi phi).
struct HorizontalMotion {
  double amplitude = 0;  ///< X, sigma
  int ratio = 1;         ///< n, its frequency relative to that along z, 1 <= n <= kLargestRatio
  double phase = 0;      ///< phi, cycles of this motion, 0 <= phi < 1
};
inline constexpr int kLargestRatio = 31;

/// Plate displacement along `axis`, with zero mean:
///
///     z(t) = A (sin(omega t) + sum_n a_n sin(n omega t + 2 pi phi_n)),   n = 2, 3, ...
///
/// Without harmonics this is A sin(omega t) (Fortini & Huang 2015, eq. 1, with z = 0 at the plate's mean): a
/// cycle begins at phase 0, where the plate passes its mean height with upward velocity A omega. With
/// harmonics a cycle begins where the first harmonic does so. Gamma, K_m and V_p are those of the first
/// harmonic.
///
/// A recorded motion replaces the formula. A sin(omega t) is then its component at omega, by least squares,
/// to which Gamma, K_m and V_p refer, and the cycles begin where this component passes its mean height
/// upwards.
///
/// A ramp changes A and omega during the run; omega t is then the integral of omega, and
///
///     z(t) = A w(omega t) - (A - A_0) w(0)
///
/// with w the bracket above: the stroke changes about the position of phase 0, so that the velocity is
/// continuous where the ramp begins, turns and ends. `amplitude` and `omega`, and all numbers that follow
/// from them, are those before the ramp; at() gives those of another cycle.
struct Drive {
  Axis axis = Axis::z;
  double amplitude = 0;                                 ///< A, sigma
  double omega = 1;                                     ///< omega, 1/t0
  std::vector<Harmonic> harmonics = {};                 ///< orders 2, 3, ...; empty: a sine
  std::shared_ptr<const RecordedMotion> recorded = {};  ///< null: the formula above
  std::optional<DriveRamp> ramp = {};                   ///< \pre its `from` is {amplitude, omega}
  std::optional<HorizontalMotion> horizontal = {};      ///< \pre axis is z
  double gravity = 1;  ///< g of the run in units of the g of its scale, > 0; 1 in a run without gravity
  /// -g_z/|g|, the share of gravity that pulls the bed onto its plate, from -1 to 1: cos(theta) of a cell
  /// tilted by theta. Gamma, K_m and the unit of time refer to |g|.
  double downward_share = 1;

  /// Gamma = A omega^2 / g, without unit, of the first harmonic or of the component at omega.
  [[nodiscard]] double gamma() const { return amplitude * omega * omega / gravity; }
  /// K_m = A^2 omega^2/(sigma g); the same number as W of Bhateja et al. 2016 and S of Eshuis et al. 2007.
  [[nodiscard]] double k_m() const { return amplitude * amplitude * omega * omega / gravity; }
  /// V_p = A omega, sigma/t0.
  [[nodiscard]] double peak_velocity() const { return amplitude * omega; }
  /// T = 2 pi / omega, t0.
  [[nodiscard]] double period() const;
  /// Displacement at `fraction` of a period (0 <= fraction < 1), sigma. The argument is the fraction rather
  /// than the time, so that the plate is periodic to the last bit in a run of any length.
  /// \param cycle number of whole periods before; only a recorded motion and a ramp depend on it
  [[nodiscard]] double displacement(double fraction, std::int64_t cycle = 0) const;
  /// Velocity at `fraction` of a period, sigma/t0.
  [[nodiscard]] double velocity(double fraction, std::int64_t cycle = 0) const;
  /// Acceleration at `fraction` of a period, sigma/t0^2.
  [[nodiscard]] double acceleration(double fraction, std::int64_t cycle = 0) const;
  /// Displacement and velocity of the plate in space, the horizontal motion included, sigma and sigma/t0.
  [[nodiscard]] Vec3 displacement_in_space(double fraction, std::int64_t cycle = 0) const;
  [[nodiscard]] Vec3 velocity_in_space(double fraction, std::int64_t cycle = 0) const;
  /// Displacement along x of the horizontal motion, sigma; 0 without one.
  /// \param fraction of a period, 0 <= fraction < 1
  [[nodiscard]] double horizontal_displacement(double fraction) const;
  /// The same for the velocity, sigma/t0.
  [[nodiscard]] double horizontal_velocity(double fraction) const;
  /// The drive as it is `cycles` cycles after its start, without the ramp: its amplitude, omega and the
  /// numbers that follow from them.
  [[nodiscard]] Drive at(double cycles) const;
  /// Cycles that are over at `time` since cycle 0 began, and the inverse.
  [[nodiscard]] double cycles_at(double time) const;
  [[nodiscard]] double time_at(double cycles) const;
  /// The cycle of a frame at `time` since cycle 0 began, whose phase is `fraction`; 0 without a recorded
  /// motion and without a ramp, as no other drive depends on it.
  [[nodiscard]] std::int64_t cycle_at(double time, double fraction) const;
  /// Whether the plate moves.
  [[nodiscard]] bool moves() const {
    return amplitude > 0 || recorded != nullptr || (ramp && ramp->to.amplitude > 0) ||
           (horizontal && horizontal->amplitude > 0);
  }
  /// A plate at rest at its mean position, with the same axis and period.
  [[nodiscard]] Drive at_rest() const {
    return {
        .axis = axis, .amplitude = 0, .omega = omega, .gravity = gravity, .downward_share = downward_share};
  }
  /// Upper bound of the length of the displacement in space, sigma: A (1 + sum a_n) of a vertical motion, A
  /// of a sine.
  [[nodiscard]] double displacement_bound() const;
  /// Upper bound of the speed in space, sigma/t0: A omega (1 + sum n a_n) of a vertical motion, A omega of a
  /// sine.
  [[nodiscard]] double velocity_bound() const;
  /// Largest downward acceleration of the whole waveform, as a positive number, sigma/t0^2: A omega^2 of a
  /// sine. A bead at rest on a horizontal plate leaves it if this exceeds g. Before a ramp.
  [[nodiscard]] double peak_fall() const;
  /// The formula of the displacement: "A sin(omega t)", or with harmonics for example
  /// "A (sin(omega t) + 0.1 sin(2 omega t + 2 pi 0.25))"; of a recorded motion its file and the first digits
  /// of the SHA-256, "recorded in trace.csv (SHA-256 1f2e3d4c...)", and of a repeated one the number of its
  /// cycles. A horizontal motion and a ramp follow after commas.
  [[nodiscard]] std::string formula() const;
};

/// A drive as the user specifies it: any set of numbers that determines A and omega without contradiction.
struct DriveSpec {
  std::optional<double> amplitude;      ///< A, sigma
  std::optional<double> omega;          ///< 1/t0
  std::optional<double> frequency;      ///< f = omega/2pi, 1/t0
  std::optional<double> gamma;          ///< A omega^2/g
  std::optional<double> k_m;            ///< A^2 omega^2/(sigma g); also W, S
  std::optional<double> peak_velocity;  ///< A omega
};

/// Whether the numbers of a DriveSpec determine A and omega: at least two independent ones are stated (omega
/// and frequency are one, and so are K_m and the peak velocity).
bool is_whole(const DriveSpec& spec);

/// The harmonics as the value of the key `harmonics`: "[[0.1, 0.25], [0.02, 0]]", to the last bit.
std::string harmonics_text(const std::vector<Harmonic>& harmonics);
/// Reads `harmonics` of the `[drive]` table of a scene or a cell.
/// \throws ConfigError for more than kMaxHarmonics, and for an amplitude or a phase out of range
std::vector<Harmonic> read_harmonics(const ConfigSection& drive);

/// Reads the six keys of a DriveSpec from the `[drive]` table of a scene or a cell.
DriveSpec read_drive_spec(const ConfigSection& drive);

/// Solves a DriveSpec for A and omega.
/// \param gravity magnitude of g in reduced units; Gamma and K_m are rejected if it is 0
/// \throws ConfigError if fewer than two independent numbers are given, if a number is negative or not
/// finite, or if the numbers disagree by more than 1e-12 relative
Drive solve_drive(const DriveSpec& spec, double gravity, const Where& where, Axis axis = Axis::z);

}  // namespace twincell
