#include "imaging/stack/representative_frames.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "imaging/codecs/codecs.hpp"
#include "imaging/geometry/lens.hpp"

namespace twincell::imaging {
namespace {

/// The picture with rotation and distortion removed.
cv::Mat without_lens(const cv::Mat& picture, double rotation_deg, double distortion) {
  const Lens lens(picture.size(), rotation_deg, distortion);
  cv::Mat2f from(picture.size());
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const PixelPoint p = lens.picture_from_ideal({double(x), double(y)});
      from(y, x) = {static_cast<float>(p.x_px), static_cast<float>(p.y_px)};
    }
  cv::Mat ideal;
  cv::remap(picture, ideal, from, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return ideal;
}

}  // namespace

std::array<int, 2> size_of_frames(FrameSource& stack) {
  cv::Mat first;
  if (!stack.next(first)) return {0, 0};
  return {first.cols, first.rows};
}

std::vector<std::string> picture_frames(FrameSource& stack, const std::vector<std::int64_t>& numbers,
                                        int longest, double rotation_deg, double distortion) {
  constexpr int kQuality = 85;  // a third of PNG's bytes where the camera has noise
  std::vector<std::string> pictures(numbers.size());
  double gain = 0;
  cv::Mat frame, byte;
  std::size_t next = 0;
  for (std::int64_t number = 0; next < numbers.size() && stack.next(frame); ++number) {
    if (number != numbers[next]) continue;
    if (gain == 0) {
      double top = 0;
      cv::minMaxLoc(frame, nullptr, &top);
      gain = frame.depth() == CV_8U || top <= 0 ? 1 : 255 / top;
    }
    frame.convertTo(byte, CV_8U, gain);
    if (rotation_deg != 0 || distortion != 0) byte = without_lens(byte, rotation_deg, distortion);
    const int by = (std::max(byte.cols, byte.rows) + longest - 1) / longest;
    if (by > 1) cv::resize(byte, byte, cv::Size(byte.cols / by, byte.rows / by), 0, 0, cv::INTER_AREA);
    const std::vector<unsigned char> bytes =
        codecs().encode(".jpg", byte, {cv::IMWRITE_JPEG_QUALITY, kQuality});
    if (bytes.empty()) throw RunError(stack.current() + ": the picture cannot be encoded as JPEG.");
    for (; next < numbers.size() && numbers[next] == number; ++next)
      pictures[next].assign(bytes.begin(), bytes.end());
  }
  return pictures;
}

}  // namespace twincell::imaging
