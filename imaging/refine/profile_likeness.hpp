#pragma once
/// \file
/// Where a picture resembles a disc of known radial profile.

#include <opencv2/core.hpp>

#include "imaging/refine/disc_profile.hpp"

namespace twincell::imaging {

/// Correlation coefficient of the picture around each pixel with the profile, over r < R (f.radius_px),
/// because pixels outside also belong to neighbours. 0 where the best-fitting level is lower than that of any
/// disc. Outside the frame the picture continues with the values of its border. Pure.
///
/// \param picture darkness
/// \param least_level smallest level of a disc, as a factor of f
/// \returns a value in -1 .. 1 for each pixel
cv::Mat1f likeness(const cv::Mat1f& picture, const DiscProfile& f, double least_level);

}  // namespace twincell::imaging
