#pragma once
/// \file
/// The circle finders that are compared: this library with each finder and the refiners `exact` and `fast`,
/// and OpenCV's two Hough transforms.

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/benchmark/cases.hpp"

namespace twincell::bench {

/// A circle finder with its settings.
struct Contestant {
  std::string name;
  /// Finds the centres in an 8-bit frame of a case, given its nominal diameters.
  std::function<std::vector<cv::Point2d>(const cv::Mat1b&, const imaging::rendered::Case&)> find;
};

/// All contestants, in the order of the table.
std::vector<Contestant> contestants();

/// The settings of one of OpenCV's transforms.
struct HoughSettings {
  int mode = 3;                ///< cv::HOUGH_GRADIENT or cv::HOUGH_GRADIENT_ALT
  double enlarge = 1;          ///< the frame is first enlarged by this factor (cubic)
  double smooth = 0;           ///< Gaussian blur applied first, px of the original frame
  double edge = 100;           ///< param1
  double votes = 100;          ///< param2
  double apart = 0.8;          ///< minDist, in units of the smallest diameter
  double radius_slack = 0.15;  ///< minRadius = smallest radius (1 - this), maxRadius = largest (1 + this)
};
std::vector<cv::Point2d> opencv_hough(const cv::Mat1b& frame, const imaging::rendered::Case& of,
                                      const HoughSettings& settings);

/// The grid on which OpenCV's settings are searched, by name.
std::vector<std::pair<std::string, HoughSettings>> hough_grid();

}  // namespace twincell::bench
