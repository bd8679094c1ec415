#pragma once
/// \file
/// Synthetic camera with the noise of a real camera.

#include "imaging/camera/options.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Returns `camera` with the given polarity (bright or dark beads) and with read_noise and
/// electrons_per_level chosen such that its pixels are as noisy, relative to the light, as those of the
/// stack's first frames (at most 3). The noise is measured by medians of second differences in dark and in
/// bright regions (noise_of in preprocess.hpp), less the quantisation noise that the synthetic film adds
/// (1/12 level^2). Where the stack's black is clipped at 0, dark regions show too little noise, and the
/// missing read noise is attributed to shot noise; the total in bright regions is right. All other options
/// are unchanged.
/// \param diameter_px bead diameter
/// \throws InputError as FrameSource, or for a stack without frames
CameraOptions with_noise_of(FrameSource& stack, double diameter_px, bool bright, CameraOptions camera);

}  // namespace twincell::imaging
