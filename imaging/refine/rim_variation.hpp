#pragma once
/// \file
/// Roundness of what discs were fitted to: how much the grey levels at their rims vary with direction.
///
/// Discs can be fitted to letters, polygons, tiles or spots of texture, and explain much of a picture. At the
/// rim of a disc the levels depend on r - R alone; at other outlines they depend on the direction too.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Largest rim_variation of discs. It is 0 to 0.023 for beads in real and drawn pictures, among them beads
/// with glare, in jpeg files, next to other beads and on textures, 0.09 for squares, 0.14 for ellipses of
/// 8:3, and more for letters and textures. Hexagons (0.02) pass.
inline constexpr double kMostRimVariation = 0.03;

/// Lower quartile over discs of one size, or the largest of the medians over those of several sizes, of the
/// variance of the grey levels around the rim that depends on the direction, divided by the variance along
/// the radius of their mean over all directions.
///
/// Levels are sampled within 0.35 R (at least 2 px) of the rim in 24 directions, relative to their mean in
/// each direction, so that uneven light does not count. Directions in which another disc or the border of the
/// picture is nearer than 1.5 px, or that reach a wall, are left out: beside an opaque wall the levels of a
/// bead vary by 0.07 to 1.2. What varies with the cosine of the direction (an error of the centre, light from
/// one side) is subtracted from each disc, and what varies with the cosine of twice the direction alike in
/// three or more discs (motion, astigmatism, stretched pixels) from all. The noise of the picture is
/// subtracted.
///
/// \param radii_px the sizes; each disc belongs to the nearest. At least one
/// \param others   discs that are not judged, but may be nearer to a rim
/// \param walls    pixels of walls, with their blurred edges, where not 0 (Prepared::opaque); empty: none
/// \returns 0 if less than a quarter of the discs show a third of their rims: in a dense packing those are at
///     objects that were not found. Pure.
double rim_variation(const cv::Mat& grey, const std::vector<Detection>& discs,
                     const std::vector<double>& radii_px, const std::vector<Detection>& others = {},
                     const cv::Mat1b& walls = {});

}  // namespace twincell::imaging
