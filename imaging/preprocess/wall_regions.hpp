#pragma once
/// \file
/// The walls, the plate and other dark regions of a frame that are too large for beads.

#include <opencv2/core.hpp>

#include "imaging/preprocess/darkness.hpp"

namespace twincell::imaging {

/// Marks the pixels of walls: of regions in which a disc of `in_radii` bead radii, dark or of an even grey,
/// has room, and of straight bars with light behind them; both with their blurred edges. Under front light,
/// which is uneven or noisy, only regions at the border of the picture count.
///
/// \param image with its light and its darkness
/// \param bright beads and walls are brighter than the background
/// \returns 255 there, else 0; empty: there are none
cv::Mat1b wall_regions(const Prepared& image, bool bright, double radius_px, double in_radii);

}  // namespace twincell::imaging
