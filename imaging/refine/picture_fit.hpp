#pragma once
/// \file
/// Sub-pixel centres by fitting the picture itself.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = sum_k a_k P(|(x, y) - c_k| - R_k), with the
/// blurred edge P of ring_normal_equations.hpp. Opaque discs do not overlap, so the sum is exact. Per bead c,
/// R and a are fitted on the ring |r - R| <= ring_px alone (glare and tracers inside do no harm), all beads
/// of a frame together (sparse_gauss_newton.hpp), and with them the blur they share, the straight way by
/// which the bed moved during the exposure, if the blur differs between directions, and a quadratic
/// correction of the light B; of a ripple that this leaves, a smooth map (residual_illumination.hpp). Discs
/// beyond the frame that darken its border (out_of_frame_discs.hpp) are fitted along. Noise is Gaussian with
/// the variance of camera noise, v = v_d + v_l (1 - d), found from the picture; residuals are weighted after
/// Huber. What R and a scatter by is found too, size by size, and serves as prior: beads of one kind need not
/// have each its own darkness fitted from noise. Then the fit is one of maximum likelihood. Bound
/// (Cramer-Rao, 15 px disc, blur 0.8 px): 0.36/SNR px per coordinate.
///
/// The first sweep, at which "fast" ends but for discs below 9 px and pictures out of focus, reads every
/// other row and leaves a twelfth of the way to go, on average; two sweeps do where the proposals are good.
///
/// When not to use: translucent discs with bright cores, or discs that overlap in projection.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell {

/// Fits all proposals of a frame together; looks once for discs that were missed, on the residual picture.
/// Pure.
Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options);
/// Its first sweep, or two (see above).
Refined refine_fast(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                    const RefineOptions& options);

inline constexpr Refiner kExactRefiner{
    .word = "exact", .help = "fit of the picture", .model = DiscModel::plain, .fit = refine};
inline constexpr Refiner kFastRefiner{
    .word = "fast", .help = "its first step", .model = DiscModel::plain, .fit = refine_fast};

}  // namespace twincell
