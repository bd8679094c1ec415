#pragma once
/// \file
/// The walls, the plate and other dark regions of a frame that are too large for beads.

#include <opencv2/core.hpp>

#include "imaging/preprocess/darkness.hpp"

namespace twincell::imaging {

/// Pixels of regions that contain a dark disc of `in_radii` bead radii, or one of an even grey, and of
/// straight bars with light behind them, with the blur of their edges. Under front light, which is uneven or
/// noisy, only regions at the border of the picture count. \param image with its light and its darkness
/// \param bright beads and walls are brighter than the background
/// \returns 255 there, else 0; empty: there are none
cv::Mat1b wall_regions(const Prepared& image, bool bright, double radius_px, double in_radii);

}  // namespace twincell::imaging
