#include "imaging/stack/formats/raw_stack.hpp"

#include <fmt/format.h>

#include <cmath>

namespace twincell::imaging::frames {

bool RawStack::next(cv::Mat& frame) {
  if (read_ == frames_) return false;
  const std::uint64_t at = place(read_);
  in_.require(at, layout_.bytes(), name(read_));
  raw_.resize(layout_.bytes());
  in_.read(at, raw_.size(), raw_.data(), name(read_));
  frame = unpack(raw_.data(), layout_);
  finish(frame);
  time_ = stamp_s(read_);
  ++read_;
  return true;
}

std::string RawStack::current() const {
  return fmt::format("{}, {}", in_.path().string(), name(read_ > 0 ? read_ - 1 : 0));
}

std::string RawStack::name(std::uint64_t i) const {
  return fmt::format("frame {}", i);
}

void RawStack::set_layout(std::uint64_t width, std::uint64_t height, int stored_bits) {
  require_plausible_size(in_.path(), width, height, 2, in_.size());
  layout_.width = info_.width = static_cast<int>(width);
  layout_.height = info_.height = static_cast<int>(height);
  layout_.stored_bits = stored_bits;
}

void RawStack::require_frames() const {
  if (frames_ == 0) in_.refuse("states that it contains no frames.");
}

void RawStack::require_last(std::uint64_t last) const {
  in_.require(last, layout_.bytes(), fmt::format("the last of its {} frames", frames_));
}

void RawStack::set_stamped_rate(std::optional<double> first_s, std::optional<double> last_s) {
  if (!first_s || !last_s || *last_s <= *first_s) return;
  info_.stamped_rate_hz = static_cast<double>(frames_ - 1) / (*last_s - *first_s);
  if (info_.frame_rate_hz && std::abs(*info_.stamped_rate_hz / *info_.frame_rate_hz - 1) > 0.01)
    info_.notes.push_back(fmt::format("the header states {:g} frames/s, but the time stamps give {:.6g}.",
                                      *info_.frame_rate_hz, *info_.stamped_rate_hz));
}

}  // namespace twincell::imaging::frames
