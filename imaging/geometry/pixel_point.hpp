#pragma once
/// \file
/// The pixel convention.
///
/// Pixel (0, 0) has its centre at x = 0, y = 0; x increases to the right (columns), y downwards (rows).
/// trackpy and OpenCV's points use the same convention; COLMAP's differs by half a pixel. Every position in
/// `imaging` follows this convention.

namespace twincell::imaging {

/// A position in a picture.
struct PixelPoint {
  double x_px = 0;  ///< to the right, from the centre of the first column
  double y_px = 0;  ///< down, from the centre of the first row
};

}  // namespace twincell::imaging
