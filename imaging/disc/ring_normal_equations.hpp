#pragma once
/// \file
/// Normal equations on the rim of a disc: the SIMD loops over pixels that take most of the time of the
/// picture fit (picture_fit.hpp).
///
/// A disc blurred by a Gaussian darkens the pixel at distance r from its centre by a P(r),
///     P = 1/2 erfc(u / (sqrt 2 s)),  u = r - R + s^2/2R.
/// The term s^2/2R is the shift of the half level of a curved edge by the blur. If the bed moves straight by
/// L during the exposure, P is the mean over t = -1/2 .. 1/2 of the P of discs at c + t L, with enough
/// Gauss-Legendre nodes to be exact to 1e-4. Blur and L are those of the whole frame. The error of P itself
/// is less than 2e-7 (Abramowitz & Stegun 7.1.26).

#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace twincell::imaging {

/// A disc of the model. Lengths in pixels.
struct Disc {
  double x = 0, y = 0;  ///< centre
  double radius = 0;    ///< R, > 1
  double darkness = 1;  ///< a
};

/// The edge of all discs of a frame.
struct EdgeBlur {
  double variance = 0.64;           ///< s^2, px^2
  std::array<double, 2> path = {};  ///< L, px; -L is equivalent

  /// Distance from R beyond which an edge is nearly 0 or 1, px: `widths` times s, and half the path.
  [[nodiscard]] double reach(double widths) const {
    return widths * std::sqrt(variance) + 0.5 * std::hypot(path[0], path[1]);
  }
};

/// Number of extra columns at the right of a picture, so that a vector may extend past the last pixel.
inline constexpr int kSpareColumns = 16;
/// Darkness value that marks a pixel of the picture as not visible.
inline constexpr float kUnseen = 1e6F;

/// Input of the sums.
struct RingArgs {
  const cv::Mat1f* picture;  ///< darkness d; kUnseen where a pixel must not be used
  const cv::Mat1f* model;    ///< T = sum of a P over all discs
  EdgeBlur blur;
  double ring = 3;              ///< pixels with |r - R| < ring count
  int row_step = 1;             ///< only rows whose index is a multiple of it are used
  double dark_variance = 1e-3;  ///< of the noise in a dark pixel (T = 1), darkness^2
  double light_variance = 0;    ///< added by full light: v = v_d + v_l (1 - T)
  double huber = 0.1;           ///< larger residuals have a reduced weight, huber/|residual|
};

/// Sums over the ring of one disc. The weight of a pixel is w = min(1, huber/|residual|)/v.
struct RingSums {
  static constexpr int kFitted = 4;                    ///< x, y, R, a
  static constexpr int kBlurs = 3;                     ///< at most; see BlurFit
  std::array<double, kFitted*(kFitted + 1) / 2> jj{};  ///< w J_i J_j, rows of the lower triangle
  std::array<double, kFitted> jr{};                    ///< w J_i residual
  std::array<double, kFitted * kBlurs> jb{};           ///< w J_i B_k
  std::array<double, kBlurs*(kBlurs + 1) / 2> bb{};    ///< w B_k B_l
  std::array<double, kBlurs> br{};                     ///< w B_k residual
  double pixels = 0;                                   ///< number of pixels used
  double squares = 0;                                  ///< w residual^2
  /// Sums of d less the model of all other discs, and of its square; unweighted.
  double seen = 0, seen_squares = 0;
  double residual_squares = 0;  ///< unweighted, residuals clipped at `huber`
};

/// Area of a ring of mean radius R and half width w, px^2: pi (R + w)^2 - pi (R - w)^2 = 4 pi R w.
inline double ring_area(double radius, double half_width) {
  return 4 * std::numbers::pi * radius * half_width;
}

/// Blur parameters that are fitted together with the discs.
enum class BlurFit {
  none,
  round,   ///< s^2
  uneven,  ///< Q_xx, Q_xy, Q_yy, about Q = 0, of a Gaussian blur s^2 + n.Q n across an edge with normal n
  path     ///< s^2, L_x, L_y
};

/// Normal equations of the ring of one disc.
/// \pre the model contains the disc itself
RingSums ring_sums(const RingArgs& args, const Disc& disc, BlurFit fit);

/// Sums of w J_i J_j^T over the pixels in both rings, J over x, y, R, a, row by row: the coupling of two
/// neighbours in the normal equations.
using PairSums = std::array<double, 16>;
/// The coupling of discs i and j.
/// \pre the model contains both
PairSums pair_sums(const RingArgs& args, const Disc& i, const Disc& j);

/// Adds a P to the model, out to the distance where P vanishes. Rows are used if their index is a multiple of
/// `row_step`.
void add_disc(cv::Mat1f& model, const Disc& disc, const EdgeBlur& blur, int row_step = 1);

/// Sums of v = max(d, 0) over the pixels nearer than R to a disc's centre. dx and dy are the distances of a
/// pixel from the centre.
struct DiscMoments {
  double mass = 0, x = 0, y = 0;  ///< v, v dx, v dy
  double xx = 0, xy = 0, yy = 0;  ///< v dx^2, v dx dy, v dy^2
  double most = 0;                ///< the largest v
};
/// \param size  size of the frame; up to kSpareColumns floats past the end of each of its rows are read
DiscMoments disc_moments(const cv::Mat1f& picture, cv::Size size, const Disc& disc);

}  // namespace twincell::imaging
