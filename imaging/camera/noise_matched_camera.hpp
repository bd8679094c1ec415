#pragma once
/// \file
/// The synthetic camera with the noise of a real one.

#include "imaging/camera/options.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell {

/// `camera` with bright beads or dark ones, and with read_noise and electrons_per_level such that its pixels
/// are as noisy, as shares of the light, as those of the stack's first frames (at most 3): medians of second
/// differences in the dark and in the light (noise_of in preprocess.hpp), less what counting to 8 bits adds
/// to the film (1/12 level^2). Where the
/// stack's black is clipped at 0 the dark shows less noise than there is, and shot noise is taken for the
/// rest: in the light the sum is right. Everything else is left as it is. \param diameter_px of a bead
/// \throws InputError as FrameSource, or for a stack without frames
CameraOptions with_noise_of(FrameSource& stack, double diameter_px, bool bright, CameraOptions camera);

}  // namespace twincell
