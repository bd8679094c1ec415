#pragma once
/// \file
/// Prediction: where the tracks are expected in a frame. Of three rules (`PredictionRule`) and a common shift
/// of all beads, the ones that fit the frame best.

#include "imaging/link/frame_match.hpp"

namespace twincell::imaging {

/// Sets `expected`, `expected_no_floor` and `ballistic`. No bead is expected below the lowest detection.
void predict(FrameMatch& match);

}  // namespace twincell::imaging
