#pragma once
/// \file
/// Evidence of a picture for a set of discs: by how much the discs describe the picture better than a model
/// without discs does. One currency for discs of any size, polarity and appearance, whichever fit found them.
///
/// Without discs, a pixel is known from its neighbourhood: its residual e_0 is the rms difference, over sqrt
/// 2, to the four pixels at the distances max(2 px, R/2) and twice that on either side on a straight line
/// through it, for the best of eight directions, so that noise alone gives its own standard deviation s_0.
/// This describes uniform areas, smooth light, and straight edges and lines of every kind (walls, tape, a
/// water line); it fails at round rims.
///
/// With discs, a pixel within 2.5 px of a disc or inside it belongs to the disc b whose rim is nearest:
///     I(p) = o_b + sum_k a_k f(r_k - R_k).
/// Where discs overlap in projection (Detection::overlap), the sum has the term of b alone. The radial
/// profile f is common to the discs of one size and is learnt from the picture, as is the scale
/// s_1 of the residual e_1 at each r - R. Where the profile describes the picture worse than the
/// neighbourhood does, summed over all discs of a size (as inside patterned discs), it is not used.
///
/// Residuals are distributed as Cauchy's, p(e) = s/(pi (s^2 + e^2)), because no model of a real picture is
/// exact. The gain of a pixel is ln p(e_1) - ln p(e_0); it is lost where a rim is predicted and none is seen.
/// Each disc costs (5/2) ln n_b (x, y, R, a, o), n_b the number of its pixels, and 1 + ln(N/n) for the choice
/// of its place, n the number of discs and N that of all pixels. Each size costs (m/2) ln N for its m profile
/// levels (Schwarz, Ann. Stat. 6, 461 (1978): a parameter costs half the logarithm of the number of values
/// that it is estimated from). With (5/2) ln N a disc, the small beads of a crystal cost more than they
/// explain, and its vacancies were taken for beads.

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Shift of the rim of a disc outwards from its circle in equal sectors of directions, the first from 0 to
/// 2 pi/24, from the residuals of its own pixels near the rim: to first order e_1 = -a_b f'(r - R) px.
struct RimShift {
  static constexpr std::size_t kSectors = 24;
  std::array<double, kSectors> px{};      ///< 0 where nothing is seen
  std::array<double, kSectors> weight{};  ///< sum of (a_b f')^2
  double radius = 0;                      ///< where the profile is steepest: mean of r by weight, px
  /// Of the residuals that no shift explains, but at most that of twice the noise and 0.02 of the range of
  /// the profile: px[k] has the variance variance/weight[k].
  double variance = 0;
};

/// Result for one set of discs, in nats: differences are logarithms of ratios of likelihoods.
struct PictureEvidence {
  double total = 0;             ///< of the whole picture; 0 without discs
  std::vector<double> of_disc;  ///< share of each disc, after its cost; < 0: the picture is better without it
  /// Mean of ln(1 + (e_1/s_1)^2) over the pixels of each disc: how unlike the other discs of its size it is.
  /// 0.53 for normal residuals of the common scale.
  std::vector<double> misfit;
  std::vector<RimShift> rims;  ///< of the discs
};

/// \param grey       CV_8U, CV_16U or CV_32F, one channel
/// \param discs      centres and radii
/// \param radii_px   the sizes; each disc belongs to the nearest. At least one
/// \param neighbour_radius_px  R of the distances above; 0: that of each disc's size. Sets of discs of
///     different sizes can be compared only if it is the same for all
/// \param walls pixels that belong to no disc where not 0; empty: none
/// Pure.
PictureEvidence picture_evidence(const cv::Mat& grey, const std::vector<Detection>& discs,
                                 const std::vector<double>& radii_px, double neighbour_radius_px = 0,
                                 const cv::Mat1b& walls = {});

/// The evidence of settings whose residuals would be the noise everywhere, nats: hardly any settings can have
/// more. Walls and text count too; they may be discs.
/// \param neighbour_radius_px R of the distances above. With that of a small disc, the rims of larger ones
///     seem straight, and the evidence for them too small
double possible_evidence(const cv::Mat& grey, double neighbour_radius_px);

/// What discs leave of a picture, grey levels: e_1 where their profile is used; elsewhere, the difference to
/// the pixels on the straight line whose rms is e_0, so that light, walls and straight edges leave nothing
/// and a disc that is missing leaves its rim. \param discs, radii_px as for picture_evidence() Pure.
cv::Mat1f residual_picture(const cv::Mat& grey, const std::vector<Detection>& discs,
                           const std::vector<double>& radii_px);

/// Index of the size, among at least one, to which a radius has the smallest ratio.
std::size_t nearest_size(double radius, const std::vector<double>& radii);

/// Gain of a pixel with residuals e_1 of scale s_1 with discs, e_0 of scale s_0 without: ln p(e_1) - ln
/// p(e_0).
double pixel_gain(double e1, double s1, double e0, double s0);

/// Standard deviation of the noise, grey levels, from the smallest fifth of the second differences, so that
/// up to half of the pixels may lie on edges. At least 1/1000 of the range of the grey levels.
double noise_level(const cv::Mat1f& grey);

}  // namespace twincell::imaging
