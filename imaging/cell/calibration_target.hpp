#pragma once
/// \file
/// Corners of a chessboard, or dots of a grid, in a picture.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell {

/// A flat pattern with equal spacing.
struct TargetPattern {
  std::string kind = "chessboard";  ///< "chessboard" (inner corners) or "dots"
  int columns = 9, rows = 6;        ///< points along x and y, 3 .. 200
};

/// The points, row by row, to sub-pixel (OpenCV's findChessboardCorners with cornerSubPix, or
/// findCirclesGrid); empty if the whole pattern is not seen.
std::vector<PixelPoint> find_target(const cv::Mat& grey, const TargetPattern& pattern);

}  // namespace twincell
