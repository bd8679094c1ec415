#pragma once
/// \file
/// Completion of a frame during the picture fit: discs that were not proposed, inside the frame and beyond
/// its border. Both are found in the residual picture d - T.

#include "imaging/refine/frame_model.hpp"

namespace twincell::imaging {

/// Smallest darkness, in the residual picture, of a disc that was not proposed, inside the frame or beyond
/// its border: half that of usual tracers, because its neighbours have absorbed a part.
inline constexpr double kMissedDarkness = 0.35;

/// Adds discs inside the frame that were not proposed. Such a disc leaves a dark disc in the residual
/// picture, of a mean darkness of at least `darkness` over 3 x 3 blocks of pixels that are together about as
/// wide as the disc. Where a known disc lies, a residual is a misfit of that disc.
/// \returns whether any was added
/// \param darkness below kMissedDarkness also discs that are paler, if they are as pale everywhere
bool add_missed(FrameModel& frame, double darkness);

/// Adds discs outside the frame that darken its border (out_of_frame_discs.hpp).
/// \param blur_known while it is not, a rim with more blur than assumed looks like a disc of which only the
///     blur is visible, and such discs are not searched for
/// \returns whether any was added
bool add_out_of_frame(FrameModel& frame, bool blur_known);

}  // namespace twincell::imaging
