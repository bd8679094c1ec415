#pragma once
/// \file
/// Where a drawing shows a point of the cell.

#include <array>
#include <opencv2/core.hpp>

#include "trajectory/box.hpp"

namespace twincell::imaging {

/// A point on the drawing.
struct Projected {
  cv::Point2d at;    ///< px, y down
  double scale = 1;  ///< px/sigma at this depth
  double depth = 0;  ///< 0 at the front of the cell, 1 at its back; 0 in a plane
};

/// Projection of the cell between the heights `bottom` and `top`. A planar cell is seen along y, x to the
/// right and z up, with the same scale everywhere. A cell in 3D is seen in perspective from the front right
/// and above: turned by 30 degrees about z and tilted by 15 degrees, from a distance of three diagonals.
class View {
 public:
  /// \param colour_bar whether room for it is left at the right
  /// \param pixels_per_sigma in the middle of the cell; 0: so that the longer side of the picture of the cell
  /// is about 900 px
  /// \throws ConfigError if a picture would have a side above 8000 px
  View(const Box& box, double bottom, double top, bool colour_bar, double pixels_per_sigma);

  /// The point of the drawing that shows a point of the cell.
  /// \param r in the cell, sigma
  [[nodiscard]] Projected project(const Vec3& r) const;
  /// Scale in the middle of the cell, px/sigma.
  [[nodiscard]] double pixels_per_sigma() const { return scale_; }
  [[nodiscard]] double height() const { return height_; }  ///< of the part of the cell that is shown, sigma
  [[nodiscard]] cv::Size size() const { return size_; }    ///< of the whole picture, px
  [[nodiscard]] cv::Rect cell() const { return cell_; }    ///< the part that shows the cell

 private:
  /// (right, up) times the magnification, the magnification, and the depth in sigma, before the scale.
  [[nodiscard]] std::array<double, 4> turned(const Vec3& r) const;

  bool planar_;
  Vec3 centre_;
  double distance_ = 0, near_ = 0, far_ = 1;
  double scale_ = 1, height_;
  cv::Point2d origin_;  ///< px of right = up = 0
  cv::Size size_;
  cv::Rect cell_;
};

}  // namespace twincell::imaging
