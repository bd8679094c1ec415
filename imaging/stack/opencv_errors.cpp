#include "imaging/stack/opencv_errors.hpp"

#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

namespace twincell::imaging {

void quiet_opencv() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  static const int hushed = setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  (void)hushed;
}

std::optional<OpencvError> opencv_error(const std::exception& e) {
  const auto* fault = dynamic_cast<const cv::Exception*>(&e);
  if (fault == nullptr) return std::nullopt;
  return OpencvError{fault->err, fault->code == cv::Error::StsNoMem};
}

}  // namespace twincell::imaging
