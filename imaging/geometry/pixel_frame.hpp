#pragma once
/// \file
/// The map between a picture and the cell.

#include <cmath>
#include <optional>

#include "imaging/geometry/lens.hpp"
#include "imaging/geometry/pixel_point.hpp"
#include "trajectory/box.hpp"

namespace twincell {

/// Map between picture and cell (x right, z up, lengths in sigma): the camera stands still in the laboratory
/// and looks along +y. A similarity, behind a lens if the picture is turned or distorted; inverse of each
/// other to rounding.
struct PixelFrame {
  double pixels_per_sigma = 15;  ///< > 0
  PixelPoint origin;  ///< where the cell's (x, z) = (0, 0) lies in the ideal picture: lower-left inside
                      ///< corner, plate at its mean
  std::optional<Lens> lens = std::nullopt;  ///< absent: the picture is the ideal one

  [[nodiscard]] Vec3 cell_from_pixel(PixelPoint p) const {
    if (lens) p = lens->ideal_from_picture(p);
    return {(p.x_px - origin.x_px) / pixels_per_sigma, 0.0, (origin.y_px - p.y_px) / pixels_per_sigma};
  }
  [[nodiscard]] PixelPoint pixel_from_cell(const Vec3& r) const {
    const PixelPoint p{origin.x_px + r.x() * pixels_per_sigma, origin.y_px - r.z() * pixels_per_sigma};
    return lens ? lens->picture_from_ideal(p) : p;
  }
};

}  // namespace twincell
