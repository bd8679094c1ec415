#pragma once
/// \file
/// How the beads of the first frame came into it.
///
/// A stack that begins while the bed flies gives its first frames to a linker that knows no bead's velocity.
/// So the first frames are linked on trial until one is calm: linked without being matched anew, nothing
/// ambiguous. From there beads are followed back to the first frame, with the velocities that are known by
/// then, and the step from the first frame to the second tells how each bead would have come in free flight.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "imaging/link/link.hpp"

namespace twincell {

/// What linking needs of a frame.
struct FrameOfBeads {
  std::vector<PixelPoint> places;
  std::vector<std::uint8_t> tracers;  ///< 1 or 0 by place, or empty
  FrameMoment moment;
};

/// Steps for `Linker::begin`, px per frame interval, in the order of the first frame's places; NaN for beads
/// that are not followed back to it, or not without doubt; none if the second frame is calm, or there is
/// none. \param frames of the stack \param read gives each; those up to the first calm one are read, at most
/// 42 \throws RunError as `Linker::next`
std::vector<PixelPoint> initial_velocities(const LinkOptions& options, int phases_per_cycle,
                                           std::size_t frames,
                                           const std::function<FrameOfBeads(std::size_t)>& read);

}  // namespace twincell
