#pragma once
/// \file
/// From light to numbers: shot noise, read noise, black level, quantisation, saturation.

#include <opencv2/core.hpp>

#include "imaging/camera/options.hpp"

namespace twincell {

/// \param light expected grey levels (of 8 bit) above the black level
/// \param frame what the noise depends on, beside the seed
/// \returns CV_8U, or CV_16U with values below 2^bits. A level of L grey levels becomes round((L + black)
/// 2^(bits-8)), held between 0 and 2^bits - 1. Electrons are Poisson (the normal distribution above 50 of
/// them).
cv::Mat read_out(const cv::Mat1f& light, const CameraOptions& options, std::int64_t frame);

}  // namespace twincell
