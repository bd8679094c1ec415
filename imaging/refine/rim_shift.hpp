#pragma once
/// \file
/// Deviation of the fitted objects' rims from circles.
///
/// Discs can be fitted to polygons, crosses, the ends of rods, tiles or spots of texture, and explain much of
/// a picture. rim_variation.hpp detects levels that vary with the direction, as those of letters do; this
/// measure detects where the rim is. It is computed from the residuals of all discs together, so it needs no
/// view of the ground around a disc, and holds in dense packings too.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell::imaging {

/// Largest rim_shift of discs. It is 0 to 0.014 for beads in real and drawn pictures, in jpeg files, next to
/// missed beads, walls and beads behind them, 0.021 on a perforated table and 0.026 in a blurred crystal;
/// 0.013 to 0.017 for octagons, 0.022 to 0.029 for honeycombs, 0.03 to 0.035 for hexagons, 0.04 to 0.06 for
/// pentagons, 0.08 to 0.09 for squares, and more for rods, crosses and textures.
inline constexpr double kMaxRimShift = 0.028;

/// Root mean square deviation of the rims of discs from circles, in units of their radius: the lower quartile
/// over the discs of a size, for the size with the largest.
///
/// Three contributions are subtracted: the best-fit circle of each disc (errors of R and of the centre, light
/// from one side); the component in cos 2 phi and sin 2 phi, phi the direction from the centre, that three or
/// more discs have in common (motion, astigmatism, stretched pixels); and the mean square that the noise of
/// the residuals is expected to add. Sectors count by their weight, so those at contacts count little.
///
/// \param rims     of picture_evidence
/// \param radii_px the sizes; each disc belongs to the nearest. At least one
/// \returns a lower bound of the quartile. It exceeds the quartile of the population from which the discs are
///     drawn with a probability of at most 0.001, or 0.75^n of n < 24 discs (sign test). 0 if no disc shows a
///     third of its rim. Pure.
double rim_shift(const std::vector<Detection>& discs, const std::vector<RimShift>& rims,
                 const std::vector<double>& radii_px);

}  // namespace twincell::imaging
