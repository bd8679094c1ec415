#pragma once
/// \file
/// Height of the plate in one frame, quickly, to a fraction of a pixel. It suffices to see which phase of the
/// drive a frame shows; cell_edges.hpp measures the plate exactly, and takes as long as locating the beads.

#include <opencv2/core.hpp>

namespace twincell::imaging {

/// Height of the plate's edge above the lowest row of the picture, px; NaN if the picture neither ends in a
/// plate nor shows one that is a bar with light below (straight_bars.hpp). In each column the edge is the
/// first crossing from dark to light, seen from below, of the level half way between plate and light. Beads
/// that touch the plate delay the crossing and never advance it, so the plate is the lower fifth of the
/// columns.
/// \param grey CV_8U, CV_16U or CV_32F
/// \param bright the plate is brighter than the background
double plate_height_px(const cv::Mat& grey, bool bright);

}  // namespace twincell::imaging
