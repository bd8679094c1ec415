#pragma once
/// \file
/// From grey levels to darkness: flat field, sign, and the regions that are neither light nor bead.

#include <opencv2/core.hpp>

namespace twincell {

/// How a frame is made ready.
struct PreprocessOptions {
  bool bright = false;  ///< discs brighter than what lies behind them (front light), not dark on a back-light
  double opaque_radii = 2.5;  ///< dark regions that hold a disc of this many bead radii are walls, > 1
};

/// A frame ready for finding and fitting.
struct Prepared {
  cv::Mat1f darkness;    ///< d = 1 - I/B: 0 where the light shines, about 1 in an opaque disc
  cv::Mat1f background;  ///< B, grey levels: quadratic surface through the light that reaches the camera
  cv::Mat1b opaque;      ///< 255 on walls, plate and other dark regions too large to be beads
};

/// Pure: grey frame (CV_8U, CV_16U or CV_32F, one channel) -> darkness.
/// \param radius_px bead radius
Prepared prepare(const cv::Mat& grey, const PreprocessOptions& options, double radius_px);

}  // namespace twincell
