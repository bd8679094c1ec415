#pragma once
/// \file
/// Selected frames of a stack as small pictures, for a report.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Width and height of the frames of a stack, px; 0 and 0 without frames. Reads the first frame.
/// \throws InputError as FrameSource
std::array<int, 2> size_of_frames(FrameSource& stack);

/// The bytes of an 8-bit JPEG for each of `numbers` (frame numbers from 0, ascending); empty for a number
/// beyond the end of the stack. Frames of more than 8 bits are scaled by the largest value of the first
/// selected frame, so that 10- and 12-bit frames are not black. A frame whose longer side exceeds `longest`
/// px is reduced by an integer factor; each new pixel is the mean of the pixels it covers. Rotation and
/// distortion (imaging/geometry/lens.hpp) are removed, so that a similarity transform maps the cell onto the
/// picture. The stack is read up to the last number.
/// \throws InputError as FrameSource
std::vector<std::string> picture_frames(FrameSource& stack, const std::vector<std::int64_t>& numbers,
                                        int longest = 800, double rotation_deg = 0, double distortion = 0);

}  // namespace twincell::imaging
