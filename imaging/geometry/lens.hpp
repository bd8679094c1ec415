#pragma once
/// \file
/// Rotation and radial distortion: the map from the ideal picture to the recorded picture.
///
/// With v the position relative to the centre of the picture, in half diagonals, rotated by the camera's
/// angle: v' = v (1 + k1 |v|^2).

#include <opencv2/core.hpp>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// The map of one camera. The rotation is counter-clockwise.
class Lens {
 public:
  Lens(cv::Size size, double rotation_deg, double distortion);
  [[nodiscard]] bool identity() const { return cos_ == 1 && k1_ == 0; }
  /// The point of the recorded picture that shows a point of the ideal one, px.
  [[nodiscard]] PixelPoint picture_from_ideal(PixelPoint p) const;
  /// The inverse map, px, to 1e-12 of the picture's size.
  [[nodiscard]] PixelPoint ideal_from_picture(PixelPoint p) const;
  /// Ratio of a length in the recorded picture to the ideal length, at a point of the ideal picture: the
  /// square root of the ratio of areas.
  [[nodiscard]] double magnification(PixelPoint ideal) const;

 private:
  double middle_x_, middle_y_, unit_, cos_, sin_, k1_;
};

}  // namespace twincell::imaging
