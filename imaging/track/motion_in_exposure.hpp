#pragma once
/// \file
/// Whether beads moved during an exposure: the blur of one frame, compared with the motion between frames.

#include <array>
#include <cstddef>
#include <vector>

#include "imaging/locate/locator.hpp"

namespace twincell::imaging {

/// The fit of a frame gives a path (Located::path_px) from edges that are blurred more along one direction.
/// An astigmatic lens or stretched pixels give the same. A path is claimed only if the beads move from this
/// frame to the one before or after by at least half of it, because an exposure is no longer than the
/// interval between frames. A single frame is not evidence. Memory: 24 bytes per frame.
class MotionInExposure {
 public:
  /// Adds the next frame.
  void add(const Located& located);
  /// The path of a frame by its own blur, px; {0, 0}: none.
  [[nodiscard]] std::array<double, 2> path(std::size_t frame) const { return paths_[frame]; }
  /// Whether the motion between frames supports that path.
  [[nodiscard]] bool claimed(std::size_t frame) const;
  /// Number of frames with a path that is not claimed.
  [[nodiscard]] std::size_t unproven() const;

 private:
  std::vector<std::array<double, 2>> paths_;
  std::vector<double> steps_;  // from frame f to f + 1: median distance of a bead to the nearest in f + 1
  std::vector<Detection> before_;
};

}  // namespace twincell::imaging
