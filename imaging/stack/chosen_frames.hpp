#pragma once
/// \file
/// Some of the frames of a stack, chosen by number.

#include <cstdint>
#include <memory>
#include <string>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Frames first, first + step, ... before `end`. Default: all frames.
struct FrameRange {
  std::int64_t first = 0;
  std::int64_t end = -1;  ///< -1: the end of the stack
  std::int64_t step = 1;

  [[nodiscard]] bool all() const { return first == 0 && end < 0 && step == 1; }
  /// Number in the stack of the chosen frame `index`.
  [[nodiscard]] std::int64_t number(std::int64_t index) const { return first + index * step; }
};

/// Reads "A:B" or "A:B:STEP": A is the first frame, from 0; B is the first one that is left out; both may be
/// absent.
/// \throws ConfigError naming the key for other text, a negative number, B <= A, or STEP < 1
FrameRange read_frame_range(const std::string& text, const std::string& key);

/// The chosen frames as a stack. Its next()
/// \throws ConfigError with the number of frames if the range begins after the end of the stack
std::unique_ptr<FrameSource> chosen_frames(std::unique_ptr<FrameSource> frames, FrameRange range);

}  // namespace twincell::imaging
