#pragma once
/// \file
/// Sub-pixel centres by fitting the picture itself.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = sum_k a_k P(|(x, y) - c_k| - R_k), with the
/// blurred edge P of disc_sums.hpp. Opaque discs do not overlap, so the sum is exact. Per bead c, R and a
/// are fitted on the ring |r - R| <= ring_px alone (glare and tracers inside do no harm), all beads of a
/// frame together (coupled_step.hpp), and with them the blur they share, the straight way by which the bed
/// moved during the exposure, if the blur differs between directions, and a quadratic correction of the light
/// B; of a ripple that this leaves, a smooth map (light_ripple.hpp). Discs beyond the frame that darken its
/// border (beyond_frame.hpp) are fitted along. Noise is Gaussian with the variance of camera noise,
/// v = v_d + v_l (1 - d), found from the picture; residuals are weighted after Huber. What R and a scatter by
/// is found too, size by size, and serves as prior: beads of one kind need not have each its own darkness
/// fitted from noise. Then the fit is one of maximum likelihood. Bound (Cramer-Rao, 15 px disc, blur 0.8 px):
/// 0.36/SNR px per coordinate.
///
/// The first sweep, at which "fast" ends but for discs below 9 px and pictures out of focus, reads every
/// other row and leaves a twelfth of the way to go, on average; two sweeps do where the proposals are good.
///
/// When not to use: translucent discs with bright cores, or discs that overlap in projection.

#include <array>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/detection.hpp"
#include "imaging/preprocess.hpp"

namespace twincell {

/// How the fit is done.
struct RefineOptions {
  std::string method = "exact";  ///< "exact": this fit; "fast": its first sweep, or two (below); "edges":
                                 ///< edge_fit.hpp; "profile": profile_fit.hpp
  int sweeps = 30;               ///< at most, 1 .. 1000
  double tolerance_px = 2e-3;    ///< a sweep that moves no bead further is the last, > 0
  double ring_px =
      0;  ///< half width of the ring, 1 .. 50; 0: three times the blur, from 2.5 to 6, or R if that is more
  double blur_px = 0;                  ///< edge blur s; 0: fitted
  double radius_spread = 0.06;         ///< prior: relative scatter of the radii about the given one, > 0
  std::vector<double> other_radii_px;  ///< of discs of further sizes, each likewise
};

/// Result of a refinement.
struct Refined {
  std::vector<Detection> beads;    ///< what may be beads
  std::vector<Detection> dropped;  ///< what turned out to be none, with its verdict
  double blur_px = 0;
  std::array<double, 2> path_px = {};  ///< by which the bed moved during the exposure, either way round
  int sweeps = 0;
};

/// Fits all proposals of a frame together; looks once for discs that were missed, on the residual picture.
/// Pure.
Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options);

}  // namespace twincell
