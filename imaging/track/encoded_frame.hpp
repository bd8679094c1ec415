#pragma once
/// \file
/// A frame as the bytes of a picture file, small enough to stand in a page.

#include <opencv2/core.hpp>
#include <string>

namespace twincell::imaging {

/// Bytes of a picture file with their media type.
struct EncodedFrame {
  std::string type;  ///< "image/png" or "image/jpeg"
  std::string bytes;
};

/// The frame in grey levels of 8 bits: PNG up to 2^18 px, JPEG of quality 90 above. A frame with more than
/// 1600 px on the longer side is reduced to that. The largest grey level of a frame with more bits becomes
/// white.
/// \pre the frame is not empty
/// \throws RunError if it cannot be encoded
EncodedFrame encoded_frame(const cv::Mat& grey);

/// A picture of residuals, encoded likewise: middle grey is up to twice the noise of the frame, which would
/// cost most of the bytes; white and black are a quarter of its range of grey levels above and below, and
/// more.
/// \pre both have the same size and are not empty
/// \throws RunError if it cannot be encoded
EncodedFrame encoded_residual(const cv::Mat& grey, const cv::Mat1f& residual);

}  // namespace twincell::imaging
