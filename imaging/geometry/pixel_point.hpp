#pragma once
/// \file
/// The pixel convention.
///
/// Pixel (0, 0) has its centre at x = 0, y = 0; x runs to the right (columns), y down (rows). This is the
/// convention of trackpy and of OpenCV's points; COLMAP's lies half a pixel away. Every position in `imaging`
/// follows it.

namespace twincell {

/// A place in a picture.
struct PixelPoint {
  double x_px = 0;  ///< to the right, from the centre of the first column
  double y_px = 0;  ///< down, from the centre of the first row
};

}  // namespace twincell
