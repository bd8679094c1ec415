#pragma once
/// \file
/// Discs that are alike but not plain (clear ones with dark rims, discs with rings printed on them): the
/// radial profile that they share is learnt from the frame, then fitted.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = g + sum_k a_k f(|(x, y) - c_k| R/R_k), with f linear between
/// levels half a pixel apart and 0 from the outer rim on, g the ground. f is first learnt from the better
/// half of the proposals; where the frame correlates with it over r < R, discs are proposed anew, and f is
/// learnt from those, twice. Then by turns c_k, R_k, a_k are found by Gauss-Newton steps, one disc at a time,
/// all others subtracted, and f and g by linear least squares from all discs that explain themselves,
/// neighbours included. Residuals beyond Huber's bound are weighted down.
///
/// When not to use: plain discs, for which picture_fit.hpp is as good and ten times faster; discs that look
/// different from each other (edge_fit.hpp).

#include <vector>

#include "imaging/refine/refiner.hpp"

namespace twincell {

/// Fits all discs that look alike with the profile that they share; the proposals need be right for most of
/// their better half only, and may miss discs. Detection::score is the share of the variance of the
/// disc's own pixels (r < R + 1) that it explains, Detection::darkness is a. Discs that explain less than
/// half are dropped. Pure. \param options RefineOptions::sweeps counts, in the last round. \returns also the
/// profile
Refined refine_by_profile(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                          const RefineOptions& options);

inline constexpr Refiner kProfileRefiner{.word = "profile",
                                         .help = "fit with the radial profile that the discs share",
                                         .model = DiscModel::shared_profile,
                                         .fit = refine_by_profile};

}  // namespace twincell
