#pragma once
/// \file
/// Stretches of a film in which the plate does not follow the drive: before the shaker starts, after it
/// stops, or in a pause.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace twincell::imaging {

/// Consecutive frames from `first` to `last`, both included.
struct FrameStretch {
  std::size_t first = 0, last = 0;
  [[nodiscard]] std::size_t size() const { return last - first + 1; }
  friend bool operator==(const FrameStretch&, const FrameStretch&) = default;
};

/// Stretches in which most frames are off the sine of the plate. A plate at rest crosses that sine twice per
/// cycle, so frames off it that are less than half a cycle apart belong to one stretch, with those between
/// them. A stretch has at least three frames off the sine; these are at least half of those in which the
/// plate is seen, and extend over half a cycle, at the first or the last frame of the film over a quarter.
/// Fewer are single heights that are misread, or phases at which something hides the plate in every cycle.
/// \param misses [frames] distance of the plate from the sine over the largest that its errors allow; NaN:
///     not seen
/// \param period of the sine, frames
std::vector<FrameStretch> stretches_out_of_lock(std::span<const double> misses, double period);

/// Number of frames in the stretches.
std::size_t frames_in(std::span<const FrameStretch> stretches);

/// The stretches as text: "0 to 39, 80 and 100 to 139". At most eight are named.
std::string in_words(std::span<const FrameStretch> stretches);

}  // namespace twincell::imaging
