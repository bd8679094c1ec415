#pragma once
/// \file
/// How far the rims of what discs were fitted to deviate from circles.
///
/// Discs can be fitted to polygons, crosses, the ends of rods, tiles or spots of texture, and explain much of a
/// picture. Other than the variation of the levels (rim_variation.hpp), this measure needs no view of the ground
/// around a disc: it is taken from the residuals of all discs together, next to neighbours too.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell::imaging {

/// Largest rim_shift of discs. It is 0 to 0.014 for beads in real and drawn pictures, in jpeg files, next to
/// missed beads, walls and beads behind them. A regular polygon of n sides, r = cos(pi/n)/cos(t) for |t| <=
/// pi/n, has 0.017 (octagon), 0.031 (hexagon), 0.046 (pentagon), 0.075 (square).
inline constexpr double kMostRimShift = 0.02;

/// Root mean square deviation of the rims of discs from circles, in units of R.
///
/// Subtracted are the best circle of each disc (errors of R and of the centre, light from one side), what goes
/// with the cosine of twice the direction alike in three or more discs (motion, astigmatism, stretched pixels),
/// and the part of the mean square that the residuals cause by chance. Sectors count by their weight, so those
/// at contacts count little.
/// \param rims     of picture_evidence
/// \param radii_px the sizes; each disc belongs to the nearest. At least one
/// \returns a lower bound of the lower quartile over the discs of a size, for the size with the largest. The
///     probability that it exceeds the quartile of the population from which the discs are drawn is at most
///     0.001, and 0.75^n of fewer than 24 discs (sign test). 0 if no disc shows a third of its rim. Pure.
double rim_shift(const std::vector<Detection>& discs, const std::vector<RimShift>& rims,
                 const std::vector<double>& radii_px);

}  // namespace twincell::imaging
