#pragma once
/// \file
/// A cell with a moving plate and a crystal that rides on it, filmed with a known camera.

#include <cmath>
#include <vector>

#include "imaging/camera/synthetic_camera.hpp"
#include "imaging/cell/cell_edges.hpp"
#include "imaging/stack/frame_source.hpp"
#include "tests/support/rigid_bed.hpp"

namespace twincell::test {

/// A small cell, 12 sigma wide.
inline RigidBed small_bed(double gamma, int cycles) {
  return {.gamma = gamma, .columns = 12, .rows = 5, .phases = 20, .cycles = cycles};
}

/// Films the bed and returns the frames in memory.
inline std::vector<cv::Mat> film(const MemoryTrajectory& bed, const imaging::CameraOptions& options) {
  const imaging::SyntheticCamera camera(options, bed.info());
  std::vector<cv::Mat> frames;
  for (std::size_t f = 0; f < bed.n_frames(); ++f) {
    const Frame& now = bed.frames()[f];
    imaging::Exposure exposure{.now = &now};
    if (f > 0) exposure.before = &bed.frames()[f - 1];
    if (f + 1 < bed.n_frames()) exposure.after = &bed.frames()[f + 1];
    exposure.late = options.trigger_offset;
    frames.push_back(camera.expose(exposure));
  }
  return frames;
}

/// Images in memory as a stack.
class FilmedFrames : public imaging::FrameSource {
 public:
  explicit FilmedFrames(std::vector<cv::Mat> frames) : frames_(std::move(frames)) {}
  bool next(cv::Mat& frame) override {
    if (at_ == frames_.size()) return false;
    frame = frames_[at_++];
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return frames_.size(); }
  [[nodiscard]] std::string current() const override { return "memory"; }

 private:
  std::vector<cv::Mat> frames_;
  std::size_t at_ = 0;
};

}  // namespace twincell::test
