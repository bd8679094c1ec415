#pragma once
/// \file
/// The pixel convention, and the map between a picture and the cell.
///
/// Pixel (0, 0) has its centre at x = 0, y = 0; x runs to the right (columns), y down (rows). This is the
/// convention of trackpy and of OpenCV's points; COLMAP's lies half a pixel away. Every position in `imaging`
/// follows it.

#include <cmath>

#include "analysis/trajectory/box.hpp"

namespace twincell {

/// A place in a picture.
struct PixelPoint {
  double x_px = 0;  ///< to the right, from the centre of the first column
  double y_px = 0;  ///< down, from the centre of the first row
};

/// Similarity between picture and cell (x right, z up, lengths in sigma): the camera stands still in the
/// laboratory and looks along +y. Inverse of each other to rounding.
struct PixelFrame {
  double pixels_per_sigma = 15;  ///< > 0
  PixelPoint origin;  ///< where the cell's (x, z) = (0, 0) lies: lower-left inside corner, plate at its mean

  [[nodiscard]] Vec3 cell_from_pixel(PixelPoint p) const {
    return {(p.x_px - origin.x_px) / pixels_per_sigma, 0.0, (origin.y_px - p.y_px) / pixels_per_sigma};
  }
  [[nodiscard]] PixelPoint pixel_from_cell(const Vec3& r) const {
    return {origin.x_px + r.x() * pixels_per_sigma, origin.y_px - r.z() * pixels_per_sigma};
  }
};

}  // namespace twincell
