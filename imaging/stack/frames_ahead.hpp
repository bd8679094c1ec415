#pragma once
/// \file
/// Look-ahead in a stack of frames.

#include <cstddef>
#include <deque>
#include <opencv2/core.hpp>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Reads a stack in order and gives access to later frames. Frames that were looked at are kept until they
/// are read, so that memory use grows with the look-ahead.
class FramesAhead {
 public:
  explicit FramesAhead(FrameSource& frames) : frames_(frames) {}
  /// The frame `ahead` frames after the next one; null if the stack ends before it.
  const cv::Mat* look(std::size_t ahead) {
    while (waiting_.size() <= ahead) {
      cv::Mat frame;
      if (!frames_.next(frame)) return nullptr;
      waiting_.push_back(frame);
    }
    return &waiting_[ahead];
  }
  /// Reads the next frame.
  /// \returns false at the end of the stack
  bool next(cv::Mat& frame) {
    if (waiting_.empty()) return frames_.next(frame);
    frame = waiting_.front();
    waiting_.pop_front();
    return true;
  }

  [[nodiscard]] const FrameSource& source() const { return frames_; }

 private:
  FrameSource& frames_;
  std::deque<cv::Mat> waiting_;
};

}  // namespace twincell::imaging
