#pragma once
/// \file
/// A frame as darkness relative to its local light, and what the darkness shows of contrast, noise and blur.

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace twincell::imaging {

/// Coefficients of 1, u, v, u^2, u v, v^2; u and v run from -1 to 1 across a frame.
using Surface = Eigen::Matrix<double, 6, 1>;
/// The six basis functions at a pixel.
Surface surface_basis(double x, double y, cv::Size size);
/// A surface along a row of pixels: a quadratic polynomial in x.
struct SurfaceRow {
  float flat, slope, curve;
  /// Value of the surface at pixel x of the row.
  [[nodiscard]] float at(int x) const {
    const auto f = static_cast<float>(x);
    return flat + (slope + curve * f) * f;
  }
};
/// The polynomial of a surface in row y.
SurfaceRow surface_row(const Surface& surface, int y, cv::Size size);

/// A preprocessed frame, the input of finding and fitting.
struct Prepared {
  /// B, grey levels: quadratic surface through the light that reaches the camera.
  Surface light = Surface::Zero();
  cv::Mat1f darkness;  ///< d = 1 - I/B: 0 in full light, about 1 in an opaque disc; each row is followed by
                       ///< kSpareColumns floats kUnseen
  cv::Mat1b opaque;    ///< 255 on walls, plate and other dark regions too large to be beads, on straight
                       ///< bars (straight_bars.hpp), and within two pixels of them; empty if there is no
                       ///< such region
  double unit = 1;     ///< share of the light that darkness 1 blocks: PreprocessOptions::contrast
};

/// Darkness of the discs relative to the background: the mean of the darker of the two classes that Otsu's
/// threshold separates. 1 if the difference of the classes is within the noise, or if the darkness is above
/// 0.6 and needs no scaling.
double contrast_of(const cv::Mat1f& darkness);

/// Variance of the camera's noise in darkness: v = dark + light (1 - d).
struct Noise {
  double dark = 1e-3, light = 0;
};

/// Noise from the medians of second differences of neighbouring pixels, in dark and in bright regions, so
/// that structures (glare, transparent beads, dust) do not count. Black that is clipped at zero shows no
/// noise, but the edge next to it is not known any better. Therefore `dark` is at least a tenth of the
/// variance in full light.
Noise noise_of(const cv::Mat1f& darkness);

/// Blur of the sharpest edges, px. The steepest gradient of an edge of darkness a is a/(s sqrt(2 pi)). For a,
/// the function takes the darkness that a twentieth of the pixels exceed; for the gradient, the value that a
/// hundredth of the pixels on edges exceed. Range 0.5 .. 5. The result is too small if discs cover less than
/// a twentieth of the frame, or if noise makes gradients. Accurate to a fifth. Pure.
double blur_of(const cv::Mat1f& darkness);

}  // namespace twincell::imaging
