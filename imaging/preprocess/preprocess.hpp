#pragma once
/// \file
/// Preprocessing: from grey levels to darkness, with the local light, the polarity and a mask of the walls.

#include <opencv2/core.hpp>

#include "imaging/preprocess/darkness.hpp"

namespace twincell::imaging {

/// Options of the preprocessing.
struct PreprocessOptions {
  bool bright = false;  ///< discs brighter than the background (front light), not dark on a back-light
  double contrast = 1;  ///< darkness of a typical disc, which is scaled to 1, 0.01 .. 2
};

/// Converts a grey frame (CV_8U, CV_16U or CV_32F, one channel) to darkness. Pure.
/// \param radius_px bead radius
Prepared prepare(const cv::Mat& grey, const PreprocessOptions& options, double radius_px);

}  // namespace twincell::imaging
