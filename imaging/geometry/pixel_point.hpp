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

inline PixelPoint operator+(PixelPoint a, PixelPoint b) {
  return {a.x_px + b.x_px, a.y_px + b.y_px};
}
inline PixelPoint operator-(PixelPoint a, PixelPoint b) {
  return {a.x_px - b.x_px, a.y_px - b.y_px};
}
inline PixelPoint operator*(double f, PixelPoint a) {
  return {f * a.x_px, f * a.y_px};
}
/// Squared length, px^2.
inline double square(PixelPoint a) {
  return a.x_px * a.x_px + a.y_px * a.y_px;
}

}  // namespace twincell::imaging
