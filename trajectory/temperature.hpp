#pragma once
/// \file
/// Granular temperature of one frame. The simulation averages it over time, the analysis over frames.

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "trajectory/centre_of_mass.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// Granular temperature of one frame, m <v'^2> = (1/N) sum m_i (v_i - v_cm)^2 over the beads present, per
/// component, in m g sigma. v_cm is the centre-of-mass velocity at that instant; rotation is not included. If
/// `mass` is empty, every mass is 1. For N beads with independent velocities of variance T/m per component,
/// the expectation is T (1 - 1/N); the factor belongs to the definition and is not corrected. NaN without
/// beads or velocities. Fortini & Huang 2015, eq. 2; Bhateja et al. 2016, eq. 5.
inline Vec3 temperature_components(const Frame& frame, const std::vector<double>& mass) {
  const auto v_cm = centre_of_mass_velocity(frame, mass);
  if (!v_cm) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vec3 sum = Vec3::Zero();
  std::size_t n = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i)
    if (frame.present(i) && frame.velocity[i].allFinite()) {
      sum += mass_of(mass, i) * (frame.velocity[i] - *v_cm).cwiseAbs2();
      ++n;
    }
  return sum / static_cast<double>(n);
}

}  // namespace twincell
