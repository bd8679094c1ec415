#pragma once
/// \file
/// Locates the beads in every frame of a stack.

#include <cstdint>
#include <functional>

#include "core/progress.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell::imaging {

/// Receives one located frame: its number from 0, the grey frame, the located beads.
using LocatedSink = std::function<void(std::int64_t frame, const cv::Mat& grey, const Located& located)>;

/// Locates every frame of a stack, `threads` frames at a time. The calling thread calls the sink in the order
/// of the frames; the results do not depend on the number of threads. Memory: a few frames.
/// \param options complete options (configure_locator.hpp)
/// \returns the number of frames
/// \throws InputError if the stack contains no frame or cannot be read
std::int64_t locate_stack(FramesAhead& frames, const LocatorOptions& options, int threads,
                          const LocatedSink& sink, Progress& progress = Progress::none());

}  // namespace twincell::imaging
