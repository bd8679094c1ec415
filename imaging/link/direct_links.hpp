#pragma once
/// \file
/// The links that need no assignment: detections without a rival near an expected position, and detections
/// where linked neighbours lead to.

#include "imaging/link/frame_match.hpp"

namespace twincell::imaging {

/// Links detections within 0.25 d of the expected position of a track if neither has a rival. If the position
/// in free flight fits another detection better, the track is left to the assignment. Sets `rival_distance`.
void link_without_rivals(FrameMatch& match);

/// Predicts open tracks from their settled neighbours, and reopens settled tracks that do not agree with
/// their neighbours and were settled by chance. Sets `neighbour_correction`.
void follow_neighbours(FrameMatch& match);

}  // namespace twincell::imaging
