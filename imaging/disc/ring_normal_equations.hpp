#pragma once
/// \file
/// The two loops over pixels on which the fit of the picture (picture_fit.hpp) spends its time, with vectors
/// as wide as the processor has.
///
/// A disc blurred by a Gaussian darkens the pixel at distance r from its centre by a P(r),
///     P = 1/2 erfc(u / (sqrt 2 s)),  u = r - R + s^2/2R.
/// The term s^2/2R is what blur does to the half level of a curved edge. Where the bed moved straight by L
/// during the exposure, P is the mean over t = -1/2 .. 1/2 of that of discs at c + t L, by as many of Gauss's
/// nodes as make it exact to 1e-4. Blur and L are those of the whole frame. P itself errs by less than 2e-7
/// (Abramowitz & Stegun 7.1.26).

#include <array>
#include <cmath>
#include <opencv2/core.hpp>

namespace twincell {

/// A disc. Lengths in pixels.
struct Disc {
  double x = 0, y = 0;  ///< centre
  double radius = 0;    ///< R, > 1
  double darkness = 1;  ///< a
};

/// The edge of all discs of a frame.
struct EdgeBlur {
  double variance = 0.64;           ///< s^2, px^2
  std::array<double, 2> path = {};  ///< L, px; -L is the same

  /// Where an edge is next to nothing, or next to all: so many s from R, px.
  [[nodiscard]] double reach(double widths) const {
    return widths * std::sqrt(variance) + 0.5 * std::hypot(path[0], path[1]);
  }
};

/// Pictures have so many more columns at the right, so that a vector may reach past the last.
inline constexpr int kSpareColumns = 16;
/// Darkness that stands for "not seen" in the picture.
inline constexpr float kUnseen = 1e6F;

/// What the sums run over.
struct RingArgs {
  const cv::Mat1f* picture;  ///< darkness d, kUnseen where nothing may be learnt
  const cv::Mat1f* model;    ///< T = sum of a P over all discs
  EdgeBlur blur;
  double ring = 3;              ///< pixels with |r - R| < ring count
  int row_step = 1;             ///< only rows whose number is a multiple of it
  double dark_variance = 1e-3;  ///< of the noise in a dark pixel (T = 1), darkness^2
  double light_variance = 0;    ///< what full light adds to it: v = v_d + v_l (1 - T)
  double huber = 0.1;           ///< residuals beyond are weighted down
};

/// Sums over the ring of one disc, of weights w = huber/v.
struct RingSums {
  static constexpr int kFitted = 4;                    ///< x, y, R, a
  static constexpr int kBlurs = 3;                     ///< as BlurFit says
  std::array<double, kFitted*(kFitted + 1) / 2> jj{};  ///< w J_i J_j, rows of the lower triangle
  std::array<double, kFitted> jr{};                    ///< w J_i residual
  std::array<double, kFitted * kBlurs> jb{};           ///< w J_i B_k
  std::array<double, kBlurs*(kBlurs + 1) / 2> bb{};    ///< w B_k B_l
  std::array<double, kBlurs> br{};                     ///< w B_k residual
  double pixels = 0;                                   ///< free to be fitted
  double squares = 0;                                  ///< w residual^2
  double seen = 0, seen_squares = 0;  ///< of what is left of d without this disc, and its square, unweighted
  double residual_squares = 0;        ///< unweighted, residuals cut at Huber's bound
};

/// What of the blur is fitted along.
enum class BlurFit {
  none,
  round,   ///< s^2
  uneven,  ///< Q_xx, Q_xy, Q_yy of a Gaussian blur s^2 + n.Q n across an edge that lies in the direction n; Q
           ///< = 0
  path     ///< s^2, L_x, L_y
};

/// Normal equations of one disc's ring; the model must contain the disc itself.
RingSums ring_sums(const RingArgs& args, const Disc& disc, BlurFit fit);

/// Sums of w J_i J_j^T over the pixels in both rings, J over x, y, R, a, row by row: how much two neighbours
/// pull at each other.
using PairSums = std::array<double, 16>;
PairSums pair_sums(const RingArgs& args, const Disc& i, const Disc& j);

/// Adds a P to the model, out to where P vanishes, in every row or in those whose number is a multiple of
/// `row_step`.
void add_disc(cv::Mat1f& model, const Disc& disc, const EdgeBlur& blur, int row_step = 1);

/// Sums over the pixels nearer than R to a disc's centre of v = max(d, 0), with dx and dy from the centre.
struct DiscMoments {
  double mass = 0, x = 0, y = 0;  ///< v, v dx, v dy
  double xx = 0, xy = 0, yy = 0;  ///< v dx^2, v dx dy, v dy^2
  double most = 0;                ///< the largest v
};
/// \param size  of the frame; behind each of its rows in the picture kSpareColumns more floats may be read
DiscMoments disc_moments(const cv::Mat1f& picture, cv::Size size, const Disc& disc);

}  // namespace twincell
