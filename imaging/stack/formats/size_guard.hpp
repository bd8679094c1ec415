#pragma once
/// \file
/// Checks that all frames of a stack have the same size.

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <string>

#include "imaging/stack/formats/byte_file.hpp"

namespace twincell::frames {

/// Stores the size of the first frame and rejects a frame of another size. The message names both frames.
class SizeGuard {
 public:
  void check(const cv::Mat& frame, const std::string& name) {
    if (first_.empty()) {
      size_ = frame.size();
      first_ = name;
    } else if (frame.size() != size_) {
      refuse(name,
             fmt::format("is {} x {} pixels, but {} is {} x {}: all frames of a stack must have one size.",
                         frame.cols, frame.rows, first_, size_.width, size_.height));
    }
  }

 private:
  cv::Size size_;
  std::string first_;
};

}  // namespace twincell::frames
