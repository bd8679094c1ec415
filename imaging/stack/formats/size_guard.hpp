#pragma once
/// \file
/// Checks that all frames of a stack have the same size and the same type of value.

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <string>

#include "imaging/stack/formats/byte_file.hpp"

namespace twincell::imaging::frames {

/// Stores size and type of value of the first frame and rejects a frame with another. The message names both
/// frames. Grey values of 8 and of 16 bits are on different scales, so a threshold of one is wrong for the
/// other.
class SizeGuard {
 public:
  /// \param name of the frame, for messages
  /// \throws InputError if size or type of value differ from those of the first frame
  void check(const cv::Mat& frame, const std::string& name) {
    if (first_.empty()) {
      size_ = frame.size();
      depth_ = frame.depth();
      first_ = name;
    } else if (frame.size() != size_) {
      refuse(name,
             fmt::format("is {} x {} pixels, but {} is {} x {}: all frames of a stack must have one size.",
                         frame.cols, frame.rows, first_, size_.width, size_.height));
    } else if (frame.depth() != depth_) {
      refuse(name, fmt::format("contains {}, but {} contains {}: all frames of a stack must have one type.",
                               values_of(frame.depth()), first_, values_of(depth_)));
    }
  }

 private:
  static std::string values_of(int depth) {
    return depth == CV_32F ? "values of type float" : depth == CV_16U ? "16-bit values" : "8-bit values";
  }

  cv::Size size_;
  int depth_ = 0;
  std::string first_;
};

}  // namespace twincell::imaging::frames
