#pragma once
/// \file
/// A stack of one picture in memory.

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// A stack of one picture in memory.
class OnePicture : public FrameSource {
 public:
  explicit OnePicture(cv::Mat picture) : picture_(std::move(picture)) {}
  bool next(cv::Mat& frame) override {
    frame = picture_;
    picture_ = cv::Mat();
    return !frame.empty();
  }
  [[nodiscard]] std::size_t announced() const override { return 1; }
  [[nodiscard]] std::string current() const override { return "picture"; }

 private:
  cv::Mat picture_;
};

}  // namespace twincell::imaging
