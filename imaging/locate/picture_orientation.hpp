#pragma once
/// \file
/// Canonical orientation of a picture among eight: flips, quarter turns and their products.
///
/// Floating-point sums depend on their order, so a locator would find a bead of a flipped picture a millionth
/// of a pixel from its flipped position. Every picture is therefore brought into one of its eight
/// orientations, which depends on the picture alone; the beads are located there and transformed back.
/// Flipping or turning a picture flips or turns the result, exact to the bit up to the rounding of n - 1 - x.

#include <array>
#include <opencv2/core.hpp>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// An orientation: the picture is first transposed, then flipped.
struct PictureOrientation {
  bool transpose = false, flip_x = false, flip_y = false;

  /// Whether the picture in this orientation is another one than that which is stored.
  [[nodiscard]] bool turns() const { return transpose || flip_x || flip_y; }
  /// The picture in this orientation.
  [[nodiscard]] cv::Mat turned(const cv::Mat& picture) const;
  /// Transforms a detection from the turned picture to the original.
  /// \param size size of the original
  [[nodiscard]] Detection back(Detection d, cv::Size size) const;
  /// Likewise for a displacement whose sign is arbitrary; the result has x >= 0.
  [[nodiscard]] std::array<double, 2> back(std::array<double, 2> displacement) const;
};

/// The orientation in which the upper and the left half of a picture are the brighter ones, and its longer
/// side is vertical (in a square picture: the direction with the larger brightness difference). A picture
/// that is its own mirror image is not flipped.
/// \param picture CV_8U, CV_16U or CV_32F, one channel
PictureOrientation canonical_picture_orientation(const cv::Mat& picture);

}  // namespace twincell::imaging
