#include "imaging/track/encoded_frame.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/error.hpp"
#include "imaging/codecs/codecs.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell::imaging {

EncodedFrame encoded_frame(const cv::Mat& grey) {
  constexpr int kLongest = 1600, kQuality = 90, kCompression = 9;
  constexpr std::size_t kExact = std::size_t{1} << 18;
  double top = 0;
  cv::minMaxLoc(grey, nullptr, &top);
  cv::Mat1b byte;
  grey.convertTo(byte, CV_8U, grey.depth() == CV_8U || top <= 0 ? 1.0 : 255 / top);
  if (const int longest = std::max(byte.cols, byte.rows); longest > kLongest) {
    const double shrink = static_cast<double>(kLongest) / longest;
    const cv::Size size(std::max(1, cvRound(shrink * byte.cols)), std::max(1, cvRound(shrink * byte.rows)));
    cv::resize(byte, byte, size, 0, 0, cv::INTER_AREA);
  }
  const bool exact = byte.total() <= kExact;
  const std::vector<int> settings = exact ? std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, kCompression}
                                          : std::vector<int>{cv::IMWRITE_JPEG_QUALITY, kQuality};
  const std::vector<unsigned char> bytes = codecs().encode(exact ? ".png" : ".jpg", byte, settings);
  if (bytes.empty()) throw RunError("A frame cannot be encoded as a picture.");
  return {exact ? "image/png" : "image/jpeg", {bytes.begin(), bytes.end()}};
}

EncodedFrame encoded_residual(const cv::Mat& grey, const cv::Mat1f& residual) {
  constexpr float kMiddle = 128, kSteps = 127, kNoises = 2, kRange = 0.25F;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  double low = 0, high = 0;
  cv::minMaxLoc(levels, &low, &high);
  const auto quiet = kNoises * static_cast<float>(noise_level(levels)),
             most = kRange * static_cast<float>(std::max(high - low, 1.0));
  cv::Mat1b byte(residual.size());
  for (int y = 0; y < byte.rows; ++y)
    for (int x = 0; x < byte.cols; ++x) {
      const float e = residual(y, x);
      byte(y, x) = cv::saturate_cast<unsigned char>(
          std::abs(e) < quiet ? kMiddle : kMiddle + kSteps * std::clamp(e / most, -1.0F, 1.0F));
    }
  return encoded_frame(byte);
}

}  // namespace twincell::imaging
