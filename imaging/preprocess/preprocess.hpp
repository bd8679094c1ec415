#pragma once
/// \file
/// From grey levels to darkness: flat field, sign, and the regions that are neither light nor bead.

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace twincell {

/// How a frame is made ready.
struct PreprocessOptions {
  bool bright = false;  ///< discs brighter than what lies behind them (front light), not dark on a back-light
  double contrast = 1;  ///< darkness of a typical disc, which shall count as 1, 0.02 .. 1
  double opaque_radii = 2.5;  ///< dark regions that hold a disc of this many bead radii are walls, > 1
};

/// Coefficients of 1, u, v, u^2, u v, v^2; u and v run from -1 to 1 across a frame.
using Surface = Eigen::Matrix<double, 6, 1>;
/// The six functions at a pixel.
Surface surface_basis(double x, double y, cv::Size size);
/// A surface along a row of pixels.
struct SurfaceRow {
  float flat, slope, curve;
  [[nodiscard]] float at(int x) const {
    const auto f = static_cast<float>(x);
    return flat + (slope + curve * f) * f;
  }
};
SurfaceRow surface_row(const Surface& surface, int y, cv::Size size);

/// A frame ready for finding and fitting.
struct Prepared {
  Surface light =
      Surface::Zero();  ///< B, grey levels: quadratic surface through the light that reaches the camera
  cv::Mat1f darkness;   ///< d = 1 - I/B: 0 where the light shines, about 1 in an opaque disc; behind each row
                        ///< stand kSpareColumns more, kUnseen
  cv::Mat1b opaque;     ///< 255 on walls, plate and other dark regions too large to be beads and within two
                        ///< pixels of them; empty if there are none
};

/// Darkness of the discs against what lies behind them: the mean of the darker of the two classes into which
/// Otsu's threshold parts a frame. 1 if that is within the noise, or near enough to 1 to be left alone.
double contrast_of(const cv::Mat1f& darkness);

/// Variance of the camera's noise in darkness: v = dark + light (1 - d).
struct Noise {
  double dark = 1e-3, light = 0;
};

/// From second differences of neighbouring pixels, in the dark and in the light, by medians: what is not
/// noise (glare, clear beads, dust) does not count. Black clipped at zero shows no noise at all, but the edge
/// beside it is known no better for that: dark is at least a tenth of what full light has.
Noise noise_of(const cv::Mat1f& darkness);

/// Blur of the sharpest edges, px: the steepest gradient of an edge of darkness a is a/(s sqrt(2 pi)). For a
/// stands what a twentieth of the pixels surpass, for the gradient what a hundredth of those with one do. 0.5
/// .. 5; too small where discs cover less than a twentieth, or noise makes gradients. Good to a fifth. Pure.
double blur_of(const cv::Mat1f& darkness);

/// Pure: grey frame (CV_8U, CV_16U or CV_32F, one channel) -> darkness.
/// \param radius_px bead radius
Prepared prepare(const cv::Mat& grey, const PreprocessOptions& options, double radius_px);

}  // namespace twincell
