#pragma once
/// \file
/// Correction of the light B of a frame from what the picture fit leaves in the gaps between the discs: first
/// by a quadratic surface q, then, if that leaves a ripple s, also by a smooth map
/// (residual_illumination.hpp). The new darkness is d' = 1 - (1 - d)/(1 - q - s).

#include "imaging/refine/frame_model.hpp"

namespace twincell::imaging {

/// Divides the light by a quadratic surface, so that the residual in the gaps between the discs vanishes.
/// Renders the model first if it is stale.
/// \returns whether the picture was changed: not by a correction far below the noise
bool level(FrameModel& frame);

/// Divides the light also by a smooth map if the quadratic surface leaves a ripple. Requires discs in place,
/// because edges with a wrong blur look like a ripple. The model may lack the last step, which was small.
/// \returns whether there was a ripple; otherwise the picture is unchanged
bool level_ripple(FrameModel& frame);

}  // namespace twincell::imaging
