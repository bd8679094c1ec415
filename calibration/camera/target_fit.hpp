#pragma once
/// \file
/// Scale, turn, bend and tilt of a camera from a flat target with points at equal spacing.

#include <vector>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/fit/fit.hpp"
#include "imaging/cell/calibration_target.hpp"

namespace twincell {

/// In the ideal picture (camera/lens.hpp) a point (a, b) of the target, in spacings from its middle, is seen
/// at
///     x = x0 + s (c a - n b)/(1 + s (g_x (c a - n b) + g_y (n a + c b))),   likewise y,   c, n = cos,
///     sin(turn),
/// g the relative change of scale per pixel along x and y: the target's plane leans away from the camera.
struct TargetFit {
  /// "pixels_per_spacing" and "x0", "y0" (px, ideal picture), "rotation" (degrees, counter-clockwise),
  /// "gradient_x", "gradient_y" (1/px), "distortion".
  FitReport fit;
  double rms_px = 0;                    ///< of both coordinates together
  std::vector<EdgeResidual> residuals;  ///< distance_px: length of the residual
};

/// \param points as find_target gives them \throws InputError for other than columns x rows points
TargetFit fit_target(const std::vector<PixelPoint>& points, const TargetPattern& pattern, cv::Size picture);

}  // namespace twincell
