#pragma once
/// \file
/// Roundness of the objects that discs were fitted to: variation of the grey levels at their rims with the
/// direction.
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
inline constexpr double kMaxRimVariation = 0.03;

/// Lower quartile over discs of one size, or the largest of the medians over those of several sizes, of the
/// variance of the grey levels around the rim that depends on the direction, divided by the variance along
/// the radius of their mean over all directions.
///
/// Levels are sampled within 0.35 R (at least 2 px) of the rim in 24 directions, relative to their mean in
/// each direction, so that uneven light does not count. Directions in which another disc or the border of the
/// picture is nearer than 1.5 px, or that reach a wall, are left out: beside an opaque wall the levels of a
/// bead vary by 0.07 to 1.2. Three contributions are subtracted: from each disc the component in cos phi and
/// sin phi, phi the direction (an error of the centre, light from one side); from all discs the component in
/// cos 2 phi and sin 2 phi that three or more of them have in common (motion, astigmatism, stretched pixels);
/// and the variance expected from the noise of the picture.
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
