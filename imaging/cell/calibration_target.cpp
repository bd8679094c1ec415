#include "imaging/cell/calibration_target.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace twincell::imaging {

std::vector<PixelPoint> find_target(const cv::Mat& grey, const TargetPattern& pattern) {
  cv::Mat picture = grey;
  if (grey.depth() != CV_8U) cv::normalize(grey, picture, 0, 255, cv::NORM_MINMAX, CV_8U);
  const cv::Size size(pattern.columns, pattern.rows);
  std::vector<cv::Point2f> points;
  if (pattern.kind == TargetKind::dots) {
    if (!cv::findCirclesGrid(picture, size, points, cv::CALIB_CB_SYMMETRIC_GRID)) return {};
  } else {
    if (!cv::findChessboardCorners(picture, size, points)) return {};
    cv::cornerSubPix(picture, points, {5, 5}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-4});
  }
  std::vector<PixelPoint> out;
  for (const cv::Point2f& p : points) out.push_back({double{p.x}, double{p.y}});
  return out;
}

}  // namespace twincell::imaging
