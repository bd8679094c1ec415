#pragma once
/// \file
/// Single frames of a stack as small pictures, for a report.

#include <cstdint>
#include <string>
#include <vector>

#include "imaging/stack/frame_source.hpp"

namespace twincell {

/// The bytes of an 8-bit PNG for each of `numbers` (frames counted from 0, ascending); empty for one that the
/// stack does not reach. All frames are divided by the largest value of the first picture, unless they have 8
/// bits already, so that 10- and 12-bit frames are not black. Frames longer than `longest` px are reduced by
/// a whole number, each pixel the mean of those it stands for. Turn and distortion (camera/lens.hpp) are
/// taken out, so that a similarity lays the cell over the picture. The stack is read up to the last number.
/// \throws InputError as FrameSource
std::vector<std::string> picture_frames(FrameSource& stack, const std::vector<std::int64_t>& numbers,
                                        int longest = 800, double rotation_deg = 0, double distortion = 0);

}  // namespace twincell
