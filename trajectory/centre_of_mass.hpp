#pragma once
/// \file
/// Position and velocity of the centre of mass of a frame.

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Height of the centre of mass, sum m_i z_i/sum m_i over the beads present, sigma, in the frame of the cell
/// (plate mean at 0); NaN if no bead is present.
/// \param mass per slot; empty: all 1
inline double centre_of_mass_height(const Frame& frame, const std::vector<double>& mass) {
  double moment = 0, total = 0;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i) || !std::isfinite(frame.position[i].z())) continue;
    const double m = mass_of(mass, i);
    moment += m * frame.position[i].z();
    total += m;
  }
  return total > 0 ? moment / total : std::numeric_limits<double>::quiet_NaN();
}

/// Velocity of the centre of mass, sum m v/sum m over the beads whose velocity is known, sigma/t0; nullopt if
/// no velocity is known.
/// \param mass per slot; empty: all 1
inline std::optional<Vec3> centre_of_mass_velocity(const Frame& frame, const std::vector<double>& mass) {
  Vec3 momentum = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < frame.velocity.size(); ++i) {
    if (!frame.present(i) || !frame.velocity[i].allFinite()) continue;
    const double m = mass_of(mass, i);
    momentum += m * frame.velocity[i];
    total += m;
  }
  if (total == 0) return std::nullopt;
  return momentum / total;
}

}  // namespace twincell
