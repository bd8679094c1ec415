#pragma once
/// \file
/// Distances between the beads of a frame, which show a wrong unit of length and beads that are listed twice.

#include <cstddef>
#include <span>

#include "trajectory/box.hpp"

namespace twincell {

/// Distance of two centres, in diameters of the smaller bead, below which they are those of one bead.
inline constexpr double kSameBead = 0.3;

/// Median over a sample of some hundred beads of the distance to the nearest other bead, in the unit of the
/// centres; NaN for fewer than two beads. Beads that are not finite are left out.
double median_spacing(std::span<const Vec3> centres);

/// Number of beads whose centre lies closer than `distance` > 0 to that of an earlier bead of the span, that
/// is how many are listed once more. Beads that are not finite are left out.
/// \param distance in the unit of the centres
std::size_t listed_again(std::span<const Vec3> centres, double distance);

}  // namespace twincell
