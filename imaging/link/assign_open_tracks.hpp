#pragma once
/// \file
/// Assignment of the tracks that are still open to the detections that are still free, at minimum total cost
/// (assignment.hpp). The cost of a link is the log-odds of its prediction error, from the most favourable of
/// several guesses of the position.

#include "imaging/link/frame_match.hpp"

namespace twincell::imaging {

/// Links the open tracks. Links whose odds against the second-best assignment are low are marked ambiguous.
/// Two links on which one disc would pass through the other are exchanged if that is not too expensive.
void assign_open_tracks(FrameMatch& match);

}  // namespace twincell::imaging
