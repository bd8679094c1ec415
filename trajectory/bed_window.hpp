#pragma once
/// \file
/// The part of the cell in which the bed lies.

#include <cstddef>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// The bed ends at walls, at the plate and at its surface. Along an axis without period, the window lies
/// between the 0.5 and the 99.5 percentile of the centres, so that a single bead that flies does not move it,
/// widened by a margin on both sides. Along a periodic axis it is the period. A planar box has no axis y.
struct BedWindow {
  std::vector<int> axes;                         ///< those along which the window has edges
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< sigma; along the other axes those of the box
  double content = 1;                            ///< area or volume, sigma^2 or sigma^3
  std::size_t beads = 0;                         ///< number of centres inside

  /// Distance of a point from the nearest edge, sigma; negative outside, infinite without edges.
  [[nodiscard]] double depth(const Vec3& r) const;
};

/// The window of these centres.
/// \param margin by which it extends beyond the percentiles, sigma
/// \pre at least one centre; all are finite
BedWindow bed_window(const std::vector<Vec3>& centres, const Box& box, double margin);

/// Centres of the beads that are present in a frame and have finite coordinates.
std::vector<Vec3> present_centres(const Frame& frame);

}  // namespace twincell
