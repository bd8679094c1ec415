#pragma once
/// \file
/// Initial velocities: the steps with which the beads of the first frame arrived there.
///
/// If a stack begins while the bed is airborne, the linker knows no bead's velocity in the first frames. The
/// first frames are therefore linked on trial until one frame is calm: it needs no collective matching, has
/// no ambiguous link and no new track. From that frame the beads are followed back to the first frame with
/// the velocities known by then. The step from the first frame to the second then gives the step with which
/// each bead would have arrived at the first frame in free flight.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "imaging/link/link.hpp"

namespace twincell::imaging {

/// The data of one frame that the linker needs.
struct FrameOfBeads {
  std::vector<PixelPoint> places;
  std::vector<std::uint8_t> tracers;  ///< 1 for a tracer, else 0, in the order of `places`; or empty
  FrameTime time;
};

/// Computes the steps for `Linker::begin`, px per frame interval, in the order of the first frame's
/// positions. A step is NaN for a bead that is not followed back to the first frame or whose link there is
/// ambiguous. The result is empty if there are fewer than three frames, if the second frame is calm, if the
/// first frame was taken twice, or if following back gives no smoother tracks.
/// \param frames number of frames in the stack
/// \param read returns frame f; frames up to the first calm one are read, at most 42
/// \throws RunError as `Linker::next`
std::vector<PixelPoint> initial_velocities(const LinkOptions& options, int phases_per_cycle,
                                           std::size_t frames,
                                           const std::function<FrameOfBeads(std::size_t)>& read);

}  // namespace twincell::imaging
