#pragma once
/// \file
/// Pictures of back-lit opaque discs with known truth.
///
/// The expected grey level of a pixel is the mean over the pixel's square (3 x 3 Gauss-Legendre nodes) and
/// over the disc's path during the exposure of
///     I(x, y) = pedestal + light(x, y) [1 - sum_k a_k P(|(x, y) - c_k|; R_k, s) + glare],
/// with P of blurred_disc.hpp. Noise is Gaussian with the variance of shot and read noise,
///     V(I) = (light/SNR)^2 [q + (1 - q)(I - pedestal)/light],   q = kReadShare,
/// and the picture is rounded to 8 bits. SNR is the light that an opaque disc blocks, divided by the noise of
/// the back-light. This code shares nothing with the locator or with the synthetic camera.

#include <cstdint>
#include <opencv2/core.hpp>

#include "imaging/benchmark/backlit_discs.hpp"

namespace twincell::imaging::rendered {

/// Expected grey levels.
/// \returns [height, width]
cv::Mat1d expected(const Picture& picture);

/// One exposure: the expected grey levels with noise, rounded to 8 bits.
cv::Mat1b expose(const cv::Mat1d& expected, const Picture& picture, double snr, std::uint64_t seed);

}  // namespace twincell::imaging::rendered
