#pragma once
/// \file
/// Picture fit: sub-pixel centres from a fit of all discs to the grey levels.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = sum_k a_k P(|(x, y) - c_k| - R_k), with the blurred edge P of
/// ring_normal_equations.hpp. Opaque discs do not overlap, so the sum is exact. For each bead c, R and a are
/// fitted on the ring |r - R| <= ring_px only, so glare and tracers inside do no harm. All beads of a frame
/// are fitted together (sparse_gauss_newton.hpp). Fitted with them are the blur that they share; if the blur
/// depends on direction, the straight path along which the bed moved during the exposure; a quadratic
/// correction of the light B; and, if that leaves a ripple, a smooth map of it (residual_illumination.hpp).
/// Discs outside the frame that darken its border are included (out_of_frame_discs.hpp). The noise is
/// Gaussian with the variance of camera noise, v = v_d + v_l (1 - d), estimated from the picture; residuals
/// are weighted after Huber. The scatter of R and a from bead to bead is estimated too, for each size, and
/// serves as a prior: beads of one kind need no individual darkness fitted from noise. With this prior the
/// fit is a maximum-likelihood fit. Bound (Cramer-Rao, 15 px disc, blur 0.8 px): 0.36/SNR px per coordinate.
///
/// The first sweep reads every other row and leaves, on average, a twelfth of the displacement. The refiner
/// "fast" stops there, except for discs below 9 px and pictures out of focus, for which it does a second
/// sweep. Where the proposals are good, two sweeps suffice for "exact".
///
/// When not to use: translucent discs with bright cores, or discs that overlap in projection.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// Fits all proposals of a frame together and searches the residual picture for missed discs. Pure.
Refined refine(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
               const RefineOptions& options);
/// The first sweep of `refine`, or its first two (see above). Pure.
Refined refine_fast(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                    const RefineOptions& options);

inline constexpr Refiner kExactRefiner{.word = "exact",
                                       .help = "fits all discs to the pixels of the frame at once",
                                       .model = DiscModel::plain,
                                       .fit = refine};
inline constexpr Refiner kFastRefiner{.word = "fast",
                                      .help = "takes only the first step of that fit",
                                      .model = DiscModel::plain,
                                      .fit = refine_fast};

}  // namespace twincell::imaging
