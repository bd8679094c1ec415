#pragma once
/// \file
/// Detection of a calibration target in a picture: corners of a chessboard or dots of a grid.

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "core/choice.hpp"
#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// The points of a target: inner corners of a chessboard, or dots.
enum class TargetKind { chessboard, dots };
/// All kinds with their words.
inline constexpr std::array kTargetKinds = {
    Choice<TargetKind>{TargetKind::chessboard, "chessboard", "inner corners of a chessboard"},
    Choice<TargetKind>{TargetKind::dots, "dots", "centres of dots on a square grid"}};

/// A flat pattern of points with equal spacing.
struct TargetPattern {
  TargetKind kind = TargetKind::chessboard;
  int columns = 9, rows = 6;  ///< points along x and y, 3 .. 200
};

/// The points of the target, row by row, with sub-pixel precision (OpenCV's findChessboardCorners with
/// cornerSubPix, or findCirclesGrid). Empty if the whole pattern is not visible.
std::vector<PixelPoint> find_target(const cv::Mat& grey, const TargetPattern& pattern);

}  // namespace twincell::imaging
