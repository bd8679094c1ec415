#pragma once
/// \file
/// Detection of a calibration target in a picture: corners of a chessboard or dots of a grid.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// A flat pattern of points with equal spacing.
struct TargetPattern {
  std::string kind = "chessboard";  ///< "chessboard" (inner corners) or "dots"
  int columns = 9, rows = 6;        ///< points along x and y, 3 .. 200
};

/// The points of the target, row by row, with sub-pixel precision (OpenCV's findChessboardCorners with
/// cornerSubPix, or findCirclesGrid). Empty if the whole pattern is not visible.
std::vector<PixelPoint> find_target(const cv::Mat& grey, const TargetPattern& pattern);

}  // namespace twincell::imaging
