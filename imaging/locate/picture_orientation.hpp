#pragma once
/// \file
/// The eight ways to hold a picture: flips, quarter turns and their products.
///
/// Sums in floating point depend on their order, so that a locator would find a bead of a flipped picture a
/// millionth of a pixel from where it should. Every picture is therefore turned into one of its eight ways
/// that only its content decides, located there, and the beads turned back: flipping or turning a picture
/// flips or turns the result, to the bit up to the rounding of n - 1 - x.

#include <array>
#include <opencv2/core.hpp>

#include "imaging/disc/detection.hpp"

namespace twincell {

/// First transposed, then flipped.
struct PictureOrientation {
  bool transpose = false, flip_x = false, flip_y = false;

  [[nodiscard]] cv::Mat turned(const cv::Mat& picture) const;
  /// A detection in the turned picture, in the original. \param size of the original
  [[nodiscard]] Detection back(Detection d, cv::Size size) const;
  /// Likewise a way whose sense does not matter; x >= 0.
  [[nodiscard]] std::array<double, 2> back(std::array<double, 2> way) const;
};

/// The way in which a picture's upper left is its brighter side, and the way down the more uneven one. A
/// picture that is its own mirror image is left as it is.
/// \param picture CV_8U, CV_16U or CV_32F, one channel
PictureOrientation canonical_picture_orientation(const cv::Mat& picture);

}  // namespace twincell
