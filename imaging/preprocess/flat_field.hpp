#pragma once
/// \file
/// Flat field: variations of the light that differ from pixel to pixel and do not change in time, such as
/// dirt and scratches on glass, lens and sensor, and the fixed pattern of the camera. Frames are divided by
/// the flat field before beads are searched. Smooth light and a drifting lamp are fitted in every frame
/// (preprocess.hpp).

#include <memory>
#include <opencv2/core.hpp>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Flat field from a stack that shows the cell without beads: its mean divided by its typical level, the 0.9
/// quantile. 1 where the light is below a fifth of this level, because that is a wall and not dirt.
/// \throws InputError if the stack contains no frame or no light
cv::Mat1f flat_of_blank(FrameSource& blank);

/// Flat field from the light between moving back-lit beads, relative to each frame's own smooth light. The
/// value of a pixel is the mean over the n frames in which the pixel and its neighbours reach at least nine
/// tenths of their largest brightness, drawn to 1 by n/(n + 2). 1 where any pixel within three pixels never
/// receives half of the light, because a bead that never moves is not dirt.
/// \param first, second  the same stack, opened twice, because it is read twice
/// \throws InputError if the stack contains no frame
cv::Mat1f flat_of_stack(FrameSource& first, FrameSource& second);

/// Mean of the frames of a stack.
/// \throws InputError if the stack contains no frame
cv::Mat1f mean_of(FrameSource& frames);

/// The frames of a stack, each minus a background plus the median of the background, of type CV_32F, so that
/// bright beads stand before an even level. Its next()
/// \throws InputError if a frame differs in size from the background
std::unique_ptr<FrameSource> without_background(std::unique_ptr<FrameSource> frames,
                                                const cv::Mat1f& background);

/// The frames of a stack, each divided by a flat field, of type CV_32F. Its next()
/// \throws InputError if a frame differs in size from the flat field
std::unique_ptr<FrameSource> flattened(std::unique_ptr<FrameSource> frames, cv::Mat1f flat);

}  // namespace twincell::imaging
