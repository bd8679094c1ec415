#pragma once
/// \file
/// The contrast of the discs of a frame, for PreprocessOptions::contrast.

#include <opencv2/core.hpp>

#include "imaging/locate/locator.hpp"

namespace twincell::imaging {

/// Darkness of a typical disc of a frame, for PreprocessOptions::contrast with the method, size and polarity
/// of the options. 1 for discs with a common profile. For the picture fit it is also 1, unless the discs are
/// so pale, or so grey in the mean, that the fit explains a fifth more with the measured contrast.
double find_contrast(const cv::Mat& grey, const LocatorOptions& options);

}  // namespace twincell::imaging
