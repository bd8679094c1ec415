#pragma once
/// \file
/// Sensor: from light to grey levels, with shot noise, read noise, black level, quantisation and saturation.

#include <opencv2/core.hpp>

#include "imaging/camera/options.hpp"

namespace twincell::imaging {

/// Reads out one frame. A light of L grey levels becomes round((L + black) 2^(bits-8)), clamped to 0 ..
/// 2^bits - 1. Electrons follow the Poisson distribution (the normal distribution above 50 electrons).
/// \param light expected grey levels (of 8 bits) above the black level
/// \param frame number that determines the noise, together with the seed
/// \returns CV_8U, or CV_16U with values below 2^bits
cv::Mat read_out(const cv::Mat1f& light, const CameraOptions& options, std::int64_t frame);

}  // namespace twincell::imaging
