#pragma once
/// \file
/// Reduced units and their laboratory values.
///
/// `sim` and `analysis` use reduced units throughout: bead diameter sigma, bead mass m, gravity g; hence t0 =
/// sqrt(sigma/g), v0 = sqrt(g sigma) (Fortini & Huang 2015, sec. II). `imaging` uses pixels and frame
/// numbers. An unknown scale is absent, never 1.

#include <cmath>
#include <optional>

namespace twincell {

/// Physical scale of a trajectory; each member may be absent.
struct Scale {
  std::optional<double> sigma_m;           ///< bead diameter, metres
  std::optional<double> gravity_m_s2;      ///< gravity, m/s^2
  std::optional<double> pixels_per_sigma;  ///< camera pixels per bead diameter

  /// t0 = sqrt(sigma/g) in seconds, if both are known. 2 mm, 9.81 m/s^2: 14.28 ms.
  [[nodiscard]] std::optional<double> t0_s() const {
    if (!sigma_m || !gravity_m_s2) return std::nullopt;
    return std::sqrt(*sigma_m / *gravity_m_s2);
  }
  /// v0 = sqrt(g sigma) in m/s, if both are known.
  [[nodiscard]] std::optional<double> v0_m_s() const {
    if (!sigma_m || !gravity_m_s2) return std::nullopt;
    return std::sqrt(*sigma_m * *gravity_m_s2);
  }
};

}  // namespace twincell
