#pragma once
/// \file
/// The Cramér–Rao bound of the centres in a rendered picture.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/benchmark/backlit_discs.hpp"

namespace twincell::imaging::rendered {

/// Smallest standard deviation per coordinate, sqrt((var x + var y)/2), of an unbiased estimate of each
/// centre, px. It follows from the Fisher information of the exposure model of picture.hpp, including the
/// information in the variance and the noise added by rounding. The free parameters are x, y, R and a of the
/// disc and of all discs that touch its blurred rim. All other parameters (their neighbours, blur, light,
/// path, glare) are taken as known.
/// \param expected expected(picture)
std::vector<double> cramer_rao_bound(const cv::Mat1d& expected, const Picture& picture, double snr);

}  // namespace twincell::imaging::rendered
