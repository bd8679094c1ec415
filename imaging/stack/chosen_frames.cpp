#include "imaging/stack/chosen_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace twincell::imaging {

namespace {

class ChosenFrames : public FrameSource {
 public:
  ChosenFrames(std::unique_ptr<FrameSource> frames, FrameRange range)
      : frames_(std::move(frames)), range_(range), wanted_(range.first) {}
  bool next(cv::Mat& frame) override {
    while (range_.end < 0 || wanted_ < range_.end) {
      if (!frames_->next(frame)) {
        if (wanted_ == range_.first)
          throw ConfigError(Where{.file = {}, .key = "--frames"},
                            fmt::format("begins with frame {}, but the stack has {} frames, counted from 0.",
                                        range_.first, at_));
        return false;
      }
      if (at_++ != wanted_) continue;
      wanted_ += range_.step;
      return true;
    }
    return false;
  }
  [[nodiscard]] std::size_t announced() const override {
    auto end = static_cast<std::int64_t>(frames_->announced());
    if (range_.end >= 0) end = std::min(end, range_.end);
    return static_cast<std::size_t>(
        std::max<std::int64_t>(0, (end - range_.first + range_.step - 1) / range_.step));
  }
  [[nodiscard]] std::string current() const override { return frames_->current(); }
  [[nodiscard]] StackInfo info() const override { return frames_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return frames_->time_s(); }

 private:
  std::unique_ptr<FrameSource> frames_;
  FrameRange range_;
  std::int64_t at_ = 0, wanted_;
};

}  // namespace

FrameRange read_frame_range(const std::string& text, const std::string& key) {
  const auto refuse = [&](const std::string& why) -> void {
    throw ConfigError(Where{.file = {}, .key = key}, fmt::format("is '{}', {}.", text, why));
  };
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  if (parts.size() < 2 || parts.size() > 3) refuse("but must be A:B or A:B:STEP");
  FrameRange range;
  std::int64_t* const numbers[] = {&range.first, &range.end, &range.step};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].empty()) continue;
    const char* end = parts[i].data() + parts[i].size();
    const auto [last, error] = std::from_chars(parts[i].data(), end, *numbers[i]);
    if (error != std::errc() || last != end || *numbers[i] < 0)
      refuse(fmt::format("but '{}' is not a whole number of 0 or more", parts[i]));
  }
  if (range.step < 1) refuse("but the step must be at least 1");
  if (range.end >= 0 && range.end <= range.first)
    refuse("but the second number, the first frame that is left out, must exceed the first");
  return range;
}

std::unique_ptr<FrameSource> chosen_frames(std::unique_ptr<FrameSource> frames, FrameRange range) {
  if (range.all()) return frames;
  return std::make_unique<ChosenFrames>(std::move(frames), range);
}

}  // namespace twincell::imaging
