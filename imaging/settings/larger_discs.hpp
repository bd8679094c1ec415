#pragma once
/// \file
/// Round regions that are larger than the beads and that no bead explains, such as a single large intruder
/// in a bed of small beads.
///
/// The search for settings needs many discs of a size; a single one has no weight there. Here the edges that
/// no bead explains vote for the centres of circles, radius by radius, on a reduced picture. Each of the best
/// circles is then fitted to the edges along its radii in the picture itself. It counts if most of the
/// directions that no bead hides show an edge of the same sign at that radius: edges of other objects are
/// there by chance in one direction of three. A group of beads that were not located has a round outline too,
/// but its inside is full of edges.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// The round regions of at least 1.4 bead diameters, and at most 0.9 of the shorter side of the picture,
/// whose centre is in the picture and that no bead overlaps by more than half its radius; largest first, no
/// two overlap. Those full of edges, as groups of beads are, are left out. Pure.
///
/// \param grey CV_8U, CV_16U or CV_32F, one channel
/// \param beads centres and radii
/// \param diameter_px of the beads; of several sizes, the largest
std::vector<LargerDisc> larger_discs(const cv::Mat& grey, const std::vector<Detection>& beads,
                                     double diameter_px);

}  // namespace twincell::imaging
