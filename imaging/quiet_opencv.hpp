#pragma once
/// \file
/// What OpenCV, and FFmpeg in it, print on stderr of themselves becomes our sentences.

#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

namespace twincell {

/// Call before the first picture or film is opened: FFmpeg's level is read once.
inline void quiet_opencv() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  static const int hushed = setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  (void)hushed;
}

}  // namespace twincell
