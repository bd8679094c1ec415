#pragma once
/// \file
/// The map between a picture and the cell.

#include <cmath>
#include <optional>

#include "imaging/geometry/lens.hpp"
#include "imaging/geometry/pixel_point.hpp"
#include "trajectory/box.hpp"

namespace twincell::imaging {

/// Map between picture and cell (x right, z up, lengths in sigma). The camera is at rest in the laboratory
/// and looks along +y. The map is a similarity, followed by a lens if the picture is rotated or distorted.
/// The two functions are inverse to each other up to rounding.
struct PixelFrame {
  double pixels_per_sigma = 15;  ///< > 0
  PixelPoint origin;  ///< position of the cell's (x, z) = (0, 0) in the ideal picture: lower-left inside
                      ///< corner, plate at its mean
  std::optional<Lens> lens = std::nullopt;  ///< absent: the picture is the ideal one

  /// The point of the plane y = 0 of the cell, sigma, at a pixel.
  [[nodiscard]] Vec3 cell_from_pixel(PixelPoint p) const {
    if (lens) p = lens->ideal_from_picture(p);
    return {(p.x_px - origin.x_px) / pixels_per_sigma, 0.0, (origin.y_px - p.y_px) / pixels_per_sigma};
  }
  /// The pixel of a point of the cell.
  /// \param r sigma; y is ignored
  [[nodiscard]] PixelPoint pixel_from_cell(const Vec3& r) const {
    const PixelPoint p{origin.x_px + r.x() * pixels_per_sigma, origin.y_px - r.z() * pixels_per_sigma};
    return lens ? lens->picture_from_ideal(p) : p;
  }
};

}  // namespace twincell::imaging
