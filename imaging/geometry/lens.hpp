#pragma once
/// \file
/// Turn and radial distortion: where a point of the ideal picture is seen.
///
/// With v the place relative to the middle of the picture, in half diagonals, turned by the camera's angle:
/// v' = v (1 + k1 |v|^2).

#include <opencv2/core.hpp>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell {

class Lens {
 public:
  Lens(cv::Size size, double rotation_deg, double distortion);
  [[nodiscard]] bool identity() const { return cos_ == 1 && k1_ == 0; }
  [[nodiscard]] PixelPoint picture_from_ideal(PixelPoint p) const;
  /// The inverse, to 1e-12 of the picture's size.
  [[nodiscard]] PixelPoint ideal_from_picture(PixelPoint p) const;
  /// Lengths in the picture over ideal ones at an ideal place: square root of the change of area.
  [[nodiscard]] double magnification(PixelPoint ideal) const;

 private:
  double middle_x_, middle_y_, unit_, cos_, sin_, k1_;
};

}  // namespace twincell
