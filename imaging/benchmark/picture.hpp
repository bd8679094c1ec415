#pragma once
/// \file
/// Pictures of back-lit opaque discs with known truth, and the Cramér–Rao bound of every centre.
///
/// The expected grey level of a pixel is the mean over the pixel's square (3 x 3 Gauss-Legendre nodes) and
/// over the disc's path during the exposure of
///     I(x, y) = pedestal + light(x, y) [1 - sum_k a_k P(|(x, y) - c_k|; R_k, s) + glare],
/// with P of blurred_disc.hpp. Noise is Gaussian with the variance of shot and read noise,
///     V(I) = (light/SNR)^2 [q + (1 - q)(I - pedestal)/light],   q = kReadShare,
/// and the picture is rounded to 8 bits. SNR is the light that an opaque disc blocks, divided by the noise of
/// the back-light. This code shares nothing with the locator or with the synthetic camera.

#include <opencv2/core.hpp>
#include <vector>

namespace twincell::imaging::rendered {

/// Share of read noise in the variance of the back-light; the rest is shot noise.
constexpr double kReadShare = 0.25;

/// An opaque disc; lengths in px, (0, 0) is the centre of the first pixel.
struct Disc {
  double x = 0, y = 0;  ///< centre, at the middle of the exposure
  double radius = 7.5;
  double contrast = 1;            ///< a: share of the light that it blocks
  double path_x = 0, path_y = 0;  ///< displacement during the exposure
  double glare = 0;               ///< peak level of a bright spot on the disc, share of the light
  double glare_x = 0, glare_y = 0, glare_size = 1;  ///< position from the disc's centre; standard deviation
};

/// The scene in front of the camera.
struct Picture {
  int width = 600, height = 1500;
  double pedestal = 20;  ///< grey level without light
  double light = 190;    ///< grey levels of the back-light above the pedestal
  double uneven = 0;     ///< 0: uniform light; u: light falls by u towards the corners, with a ripple of u/10
  double blur = 0.8;     ///< s: standard deviation of the optical blur, px
  std::vector<Disc> discs;
};

/// Expected grey levels. \returns [height, width]
cv::Mat1d expected(const Picture& picture);

/// One exposure: the expected grey levels with noise, rounded to 8 bits.
cv::Mat1b expose(const cv::Mat1d& expected, const Picture& picture, double snr, std::uint64_t seed);

/// Smallest standard deviation per coordinate, sqrt((var x + var y)/2), of an unbiased estimate of each
/// centre, px. It follows from the Fisher information of the exposure model above, including the information
/// in the variance and the noise added by rounding. The free parameters are x, y, R and a of the disc and of
/// all discs that touch its blurred rim. All other parameters (their neighbours, blur, light, path, glare)
/// are taken as known.
std::vector<double> cramer_rao_bound(const cv::Mat1d& expected, const Picture& picture, double snr);

}  // namespace twincell::imaging::rendered
