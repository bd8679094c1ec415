#pragma once
/// \file
/// The branch vector of a contact.

#include "trajectory/trajectory.hpp"

namespace twincell {

/// From the centre of j to that of i, (R_i + R_j - overlap) n; or from the wall to the centre of i,
/// (R_i - overlap) n; sigma. Radii as radius_of() gives them.
inline Vec3 branch_vector(const ContactForce& c, const TrajectoryInfo& info) {
  const auto radius = [&](std::int32_t bead) {
    return radius_of(info.radius, static_cast<std::size_t>(bead));
  };
  return (radius(c.i) + (c.j >= 0 ? radius(c.j) : 0) - c.overlap) * c.normal;
}

}  // namespace twincell
