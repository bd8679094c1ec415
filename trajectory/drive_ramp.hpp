#pragma once
/// \file
/// Linear change in time of the frequency and of the strength of a drive, over a number of its cycles.

namespace twincell {

/// Amplitude and angular frequency of a drive at one instant.
struct DriveLevel {
  double amplitude = 0;  ///< A, sigma
  double omega = 1;      ///< 1/t0
  friend bool operator==(const DriveLevel&, const DriveLevel&) = default;
};

/// A ramp. With the time s since its beginning and its duration D (half of it if it returns), u = s/D,
///
///     omega(u) = omega_0 + (omega_1 - omega_0) u
///     A(u) omega(u)^power = A_0 omega_0^power + (A_1 omega_1^power - A_0 omega_0^power) u
///
/// The phase is the integral of omega, so that D = 4 pi n/(omega_0 + omega_1) for n cycles. Before the ramp
/// the drive is at `from`, after it at `to`, or at `from` if it returns.
struct DriveRamp {
  DriveLevel from, to;
  int power = 2;         ///< what is linear in time: 0 the amplitude, 1 the peak velocity, 2 Gamma
  double first = 0;      ///< cycle at which it begins, whole, counted from the start of the drive
  double cycles = 1;     ///< its length, whole; even if it returns
  bool returns = false;  ///< half of the cycles lead from `from` to `to`, the other half back

  /// Amplitude, its first and second time derivative, omega and its time derivative, at one instant.
  struct State {
    double amplitude, rate, curvature;
    double omega, omega_rate;
  };
  /// The state `at` cycles after the start of the drive.
  /// \param at may be any number
  [[nodiscard]] State state(double at) const;
  [[nodiscard]] DriveLevel level(double at) const;
  /// Time from the start of the drive until `at` cycles are over, t0, and its inverse.
  [[nodiscard]] double time_at(double at) const;
  [[nodiscard]] double cycles_at(double time) const;
  [[nodiscard]] bool changes_frequency() const { return from.omega != to.omega; }
  /// The level after the ramp.
  [[nodiscard]] DriveLevel end() const { return returns ? from : to; }
  /// Largest value of A omega^exponent, sigma/t0^exponent, on the way, the ends included.
  [[nodiscard]] double largest(int exponent) const;
  /// Upper bound of |dA/dt|, sigma/t0.
  [[nodiscard]] double rate_bound() const;
  /// The name of what is linear in time: "the amplitude", "the peak velocity", "Gamma".
  [[nodiscard]] const char* linear_quantity() const;
};

}  // namespace twincell
