#pragma once
/// \file
/// Specks and scratches on the glass, the same in every frame.

#include <opencv2/core.hpp>

#include "imaging/camera/options.hpp"

namespace twincell::imaging {

/// Share of the light that the glass transmits, [height, width], 0 .. 1. Specks are discs of radius 0.5 to 4
/// px, 20 to 80 % dark. Scratches are straight lines, 30 px to half the picture's height long, 0.5 to 1.5 px
/// wide, 10 to 50 % dark. All edges have the blur of the optics.
cv::Mat1f glass(cv::Size size, const CameraOptions& options);

}  // namespace twincell::imaging
