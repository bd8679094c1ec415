#pragma once
/// \file
/// What of the light differs from pixel to pixel and stays: grime and scratches on glass, lens and sensor,
/// the camera's own pattern. The frames are divided by it before anything is sought in them; what is smooth,
/// and a lamp that drifts, is fitted frame by frame anyway (preprocess.hpp).

#include <memory>
#include <opencv2/core.hpp>

#include "imaging/stack/frame_source.hpp"

namespace twincell {

/// The mean of a stack that shows the cell without beads, over its typical level, the nine tenths quantile. 1
/// where the light is below a fifth of that: there a wall stands, not grime. \throws InputError if it holds
/// no frame or no light
cv::Mat1f flat_of_blank(FrameSource& blank);

/// The same from the light between back-lit beads that move, relative to each frame's own smooth light: at
/// each pixel the mean over the n frames in which it and those beside it are at least nine tenths as bright
/// as they ever are, drawn to 1 by n/(n + 2). 1 where nothing, or less than half of the light, was ever seen
/// within three pixels: a bead that never moves is no grime. \param first, second  the same stack, opened
/// twice: it is read twice \throws InputError if it holds no frame
cv::Mat1f flat_of_stack(FrameSource& first, FrameSource& second);

/// The frames of a stack, each divided by a flat field, of type CV_32F. next() \throws InputError if they are
/// not of its size
std::unique_ptr<FrameSource> flattened(std::unique_ptr<FrameSource> frames, cv::Mat1f flat);

}  // namespace twincell
