#pragma once
/// \file
/// Camera calibration from a flat target with equally spaced points: scale, rotation, distortion and tilt.

#include <vector>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/fit/fit.hpp"
#include "imaging/cell/calibration_target.hpp"

namespace twincell::calibration {

/// Model of the target. The point (a, b) of the target, in spacings from its centre, appears in the ideal
/// picture (imaging/geometry/lens.hpp) at
///     x = x0 + s (c a - n b)/(1 + s (g_x (c a - n b) + g_y (n a + c b))),   likewise y,
/// with c, n = cos, sin(rotation), s the pixels per spacing, and g the relative change of scale per pixel
/// along x and y, which is nonzero if the plane of the target is tilted against the picture plane.
struct TargetFit {
  /// "pixels_per_spacing" and "x0", "y0" (px, ideal picture), "rotation" (degrees, counter-clockwise),
  /// "gradient_x", "gradient_y" (1/px), "distortion".
  FitReport fit;
  double rms_px = 0;                    ///< over both coordinates
  std::vector<EdgeResidual> residuals;  ///< distance_px: length of the residual
};

/// Fits the model to the points of one picture.
/// \param points as returned by find_target
/// \throws InputError for other than columns x rows points
TargetFit fit_target(const std::vector<imaging::PixelPoint>& points, const imaging::TargetPattern& pattern,
                     cv::Size picture);

}  // namespace twincell::calibration
