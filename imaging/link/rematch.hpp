#pragma once
/// \file
/// Second look at a frame whose links are doubtful: all beads are matched at once (collective_matching.hpp),
/// also with the next frame as evidence, and in a closed cell the last tracks take what is left over.

#include <vector>

#include "imaging/link/frame_match.hpp"

namespace twincell::imaging {

/// Whether the links are implausible: touching neighbours separate, or a track has no detection although one
/// is left over.
bool neighbours_separate(const FrameMatch& match);

/// Matches all tracks and detections collectively and replaces the links. If there are many more choices than
/// in one layer of discs, the links are unchanged.
/// \param steps_back for each detection, in the order of the grid, the displacement in free flight that leads
///     to it, extrapolated back from the next frame; NaN where unknown, or empty
void match_all(FrameMatch& match, const std::vector<PixelPoint>& steps_back);

/// Whether beads follow ballistic paths. Otherwise, as in tables of hopping points, the next frame is no
/// evidence for a link. Of the beads that are not at their expected position, more than one in three must be
/// closer to a path with one collision by a factor of two.
bool follows_ballistic(const FrameMatch& match, const std::vector<PixelPoint>& steps_back);

/// In a complete frame of a closed cell: links the last tracks to the detections left over. A bead that is
/// hit hard may move farther than the search reaches. No prediction supports such a link, so it is marked
/// ambiguous.
void link_left_over(FrameMatch& match);

}  // namespace twincell::imaging
