#pragma once
/// \file
/// Beads in every frame of a stack.

#include <cstdint>
#include <functional>

#include "core/progress.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell {

/// Takes one located frame: its number from 0, the grey frame, what was found.
using LocatedSink = std::function<void(std::int64_t frame, const cv::Mat& grey, const Located& located)>;

/// Locates every frame of a stack, `threads` frames at a time; the sink is called in the order of the frames,
/// by the calling thread, and sees the same whatever the number of threads. Memory: a few frames.
/// \param options complete ones (configure_locator.hpp)
/// \returns the number of frames \throws InputError if the stack holds no frame or cannot be read
std::int64_t locate_stack(FramesAhead& frames, const LocatorOptions& options, int threads,
                          const LocatedSink& sink, Progress& progress = Progress::none());

}  // namespace twincell
