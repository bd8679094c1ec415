#pragma once
/// \file
/// The sinusoidal drive and its dimensionless numbers.

#include <cstdint>
#include <optional>

#include "core/config.hpp"
#include "core/error.hpp"
#include "trajectory/box.hpp"

namespace twincell {

/// Plate displacement A sin(omega t) along `axis` (Fortini & Huang 2015, eq. 1, with z = 0 at the plate's
/// mean). A cycle begins at phase 0, where the plate passes its mean height with upward velocity A omega.
struct Drive {
  Axis axis = Axis::z;
  double amplitude = 0;  ///< A, sigma
  double omega = 1;      ///< omega, 1/t0

  /// Gamma = A omega^2 / g, with g in reduced units (1).
  [[nodiscard]] double gamma(double gravity = 1) const { return amplitude * omega * omega / gravity; }
  /// K_m = A^2 omega^2/(sigma g); the same number as W of Bhateja et al. 2016 and S of Eshuis et al. 2007.
  [[nodiscard]] double k_m(double gravity = 1) const {
    return amplitude * amplitude * omega * omega / gravity;
  }
  /// V_p = A omega, sigma/t0.
  [[nodiscard]] double peak_velocity() const { return amplitude * omega; }
  /// T = 2 pi / omega, t0.
  [[nodiscard]] double period() const;
  /// Displacement at `fraction` of a period (0 <= fraction < 1), sigma. The argument is the fraction rather
  /// than the time, so that the plate is periodic to the last bit in a run of any length.
  [[nodiscard]] double displacement(double fraction) const;
  /// Velocity at `fraction` of a period, sigma/t0.
  [[nodiscard]] double velocity(double fraction) const;
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

/// Reads the six keys of a DriveSpec from the `[drive]` table of a scene or a cell.
DriveSpec read_drive_spec(const ConfigSection& drive);

/// Solves a DriveSpec for A and omega.
/// \param gravity magnitude of g in reduced units; Gamma and K_m are rejected if it is 0
/// \throws ConfigError if fewer than two independent numbers are given, if a number is negative or not
/// finite, or if the numbers disagree by more than 1e-12 relative
Drive solve_drive(const DriveSpec& spec, double gravity, const Where& where, Axis axis = Axis::z);

}  // namespace twincell
