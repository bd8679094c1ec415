#pragma once
/// \file
/// Frames that a conversion of the frame rate, or a copy, has stored more than once. The noise of a camera
/// makes no two frames equal.

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "imaging/stack/chosen_frames.hpp"

namespace twincell::imaging {

/// Notices frames that equal the frame before them to the bit. Memory: 16 bytes per frame and one frame.
class RepeatedFrames {
 public:
  /// \param frame the next frame, of one channel
  void add(const cv::Mat& frame);

  /// [frames] 1 where the frame repeats the one before it; empty if no frame does.
  ///
  /// A film without noise, or of a bed at rest, also has equal frames. They count only if the picture changes
  /// on both sides of some of them as it usually does (by at least half the median of the changes of grey
  /// level) and not back to what it was, as it does where a plate turns round between two frames; and at most
  /// six equal frames in a row.
  [[nodiscard]] std::vector<std::uint8_t> repeats() const;

  /// "frames 48 to 95 equal frames 0 to 47 to the bit: ...", without a full stop: the longest part, of at
  /// least eight frames in motion, that is in the stack twice; empty if there is none. A film without noise
  /// of a motion that repeats itself throughout, three times or more, is no copy.
  [[nodiscard]] std::string copied() const;

 private:
  std::vector<std::uint64_t> hashes_;
  std::vector<double> changes_;  ///< mean change of grey level since the frame before
  cv::Mat before_;
};

/// "16 of 96 frames equal the frame before them to the bit, the first of them frame 5: ...", without a full
/// stop; empty if no frame repeats another.
/// \param repeats as RepeatedFrames::repeats
/// \param range the frames of the stack that they are
std::string repeats_in_words(std::span<const std::uint8_t> repeats, const FrameRange& range = {});

}  // namespace twincell::imaging
