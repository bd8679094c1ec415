#include "imaging/preprocess/flat_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging {

namespace {

/// Light of each pixel relative to the frame's own smooth light.
cv::Mat1f share_of_light(const cv::Mat& frame) {
  constexpr double kRadius = 10;  // px; affects only the search for walls, which is not used here
  return 1 - prepare(frame, {}, kRadius).darkness;
}

/// Minimum within a square of half width `reach`, px.
cv::Mat1f least_within(const cv::Mat1f& values, int reach) {
  cv::Mat1f least;
  cv::erode(values, least, cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
  return least;
}

/// Mean over 3 x 3 pixels, so that the noise of single pixels does not decide how bright a pixel is.
cv::Mat1f smoothed(const cv::Mat1f& values) {
  cv::Mat1f smooth;
  cv::blur(values, smooth, {3, 3});
  return smooth;
}

[[noreturn]] void refuse(const FrameSource& source, const std::string& why) {
  throw InputError(Where{.file = source.current(), .key = {}}, why);
}

/// How a flat field changes a frame.
enum class Correction { divide, subtract };

class Flattened : public FrameSource {
 public:
  Flattened(std::unique_ptr<FrameSource> frames, cv::Mat1f flat, Correction correction)
      : frames_(std::move(frames)), flat_(std::move(flat)), correction_(correction) {}
  bool next(cv::Mat& frame) override {
    cv::Mat raw;
    if (!frames_->next(raw)) return false;
    if (raw.size() != flat_.size())
      refuse(*frames_, fmt::format("is {} x {} px, but the {} is {} x {} px.", raw.cols, raw.rows,
                                   correction_ == Correction::divide ? "flat field" : "background picture",
                                   flat_.cols, flat_.rows));
    // A new matrix, because the caller may keep the previous one.
    frame = cv::Mat();
    if (correction_ == Correction::divide)
      cv::divide(raw, flat_, frame, 1, CV_32F);
    else
      cv::subtract(raw, flat_, frame, cv::noArray(), CV_32F);
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return frames_->announced(); }
  [[nodiscard]] std::string current() const override { return frames_->current(); }
  [[nodiscard]] StackInfo info() const override { return frames_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return frames_->time_s(); }

 private:
  std::unique_ptr<FrameSource> frames_;
  cv::Mat1f flat_;
  Correction correction_;
};

cv::Mat1d sum_of(FrameSource& stack, int& frames) {
  cv::Mat1d sum;
  frames = 0;
  for (cv::Mat frame; stack.next(frame); ++frames) {
    cv::Mat1d levels;
    frame.convertTo(levels, CV_64F);
    sum = sum.empty() ? levels : cv::Mat1d(sum + levels);
  }
  if (frames == 0) refuse(stack, "contains no frames.");
  return sum;
}

}  // namespace

cv::Mat1f flat_of_blank(FrameSource& blank) {
  constexpr double kTypicalQuantile = 0.9;  // of the levels
  constexpr double kMaxWallLevel = 0.2;     // fraction of the typical level
  int frames = 0;
  const cv::Mat1d sum = sum_of(blank, frames);
  std::vector<double> sorted(sum.begin(), sum.end());
  const auto at = static_cast<std::ptrdiff_t>(kTypicalQuantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  const double typical = sorted[static_cast<std::size_t>(at)];
  if (!(typical > 0)) refuse(blank, "contains no light; no flat field can be computed from it.");
  cv::Mat1f flat;
  sum.convertTo(flat, CV_32F, 1 / typical);
  flat.setTo(1, flat < kMaxWallLevel);
  return flat;
}

cv::Mat1f flat_of_stack(FrameSource& first, FrameSource& second) {
  constexpr double kMinBrightness = 0.9;  // of a pixel without beads, fraction of its largest brightness
  constexpr double kMinLight = 0.5;       // darker pixels are walls; share of the light
  constexpr double kPriorFrames = 2;      // frames of level 1 that the mean of a pixel starts from
  constexpr int kNeighbours = 1, kWallMargin = 3;  // px
  // First reading: the largest brightness of each pixel, smoothed against noise.
  cv::Mat1f brightest;
  for (cv::Mat frame; first.next(frame);) {
    const cv::Mat1f light = smoothed(share_of_light(frame));
    brightest = brightest.empty() ? light : cv::Mat1f(cv::max(brightest, light));
  }
  if (brightest.empty()) refuse(first, "contains no frames.");
  // Second reading: the mean of each pixel over the frames in which no bead darkens it or its neighbours.
  const cv::Mat1f enough = kMinBrightness * brightest;
  cv::Mat1f sum = cv::Mat1f::zeros(brightest.size()), count = sum.clone();
  for (cv::Mat frame; second.next(frame);) {
    const cv::Mat1f light = share_of_light(frame);
    const cv::Mat1f over = least_within(smoothed(light) - enough, kNeighbours);
    const cv::Mat1b seen = over >= 0;
    cv::add(sum, light, sum, seen);
    cv::add(count, 1, count, seen);
  }
  cv::Mat1f flat = (sum + kPriorFrames) / (count + kPriorFrames);
  flat.setTo(1, least_within(brightest, kWallMargin) < kMinLight);
  return flat;
}

std::unique_ptr<FrameSource> flattened(std::unique_ptr<FrameSource> frames, cv::Mat1f flat) {
  return std::make_unique<Flattened>(std::move(frames), std::move(flat), Correction::divide);
}

cv::Mat1f mean_of(FrameSource& stack) {
  int frames = 0;
  const cv::Mat1d sum = sum_of(stack, frames);
  cv::Mat1f mean;
  sum.convertTo(mean, CV_32F, 1.0 / frames);
  return mean;
}

std::unique_ptr<FrameSource> without_background(std::unique_ptr<FrameSource> frames,
                                                const cv::Mat1f& background) {
  const float level = upper_median(std::vector<float>(background.begin(), background.end()));
  return std::make_unique<Flattened>(std::move(frames), cv::Mat1f(background - level), Correction::subtract);
}

}  // namespace twincell::imaging
