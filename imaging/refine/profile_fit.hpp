#pragma once
/// \file
/// Profile fit, for discs that look alike but are not plain (clear ones with dark rims, discs with printed
/// rings): their common radial profile is learnt from the frame and then fitted.
///
/// Model, in darkness d = 1 - I/B:  d(x, y) = g + sum_k a_k f(|(x, y) - c_k| R/R_k). The profile f is linear
/// between levels half a pixel apart and 0 from the outer rim on; g is the ground. First f is learnt from the
/// better half of the proposals. Discs are then proposed again where the frame correlates with f over r < R,
/// and f is learnt from those; this is done twice. Then two steps alternate: c_k, R_k and a_k are fitted by
/// Gauss-Newton steps, one disc at a time with all others subtracted; f and g are fitted by linear least
/// squares to all well-explained discs together, with their neighbours included. Residuals beyond Huber's
/// bound have reduced weight.
///
/// Highlights beside the middle of the discs attract all centres by the same vector. If the mean square of
/// the residuals at r > 0.85 R is above 0.001, and another place of the centres lowers it by a quarter, the
/// model has a second term a_k t((x, y) - c_k), a common picture of the inside (r < 0.9 R), and the centres
/// are those of the rims.
///
/// When not to use: plain discs, for which picture_fit.hpp is as good and ten times faster; discs that look
/// different from each other (edge_fit.hpp).

#include <vector>

#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// Fits all discs that look alike with their common profile. Only most of the better half of the proposals
/// must be right; the proposals may miss discs. Detection::score is the fraction of the variance of the
/// disc's own pixels (r < R + 1) that it explains; Detection::darkness is a. Discs that explain less than
/// half are dropped. Pure.
/// \param options RefineOptions::sweeps limits the sweeps of the last round
/// \returns the discs and the profile
Refined refine_by_profile(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                          const RefineOptions& options);

inline constexpr Refiner kProfileRefiner{.word = "profile",
                                         .help = "fits all discs with one shared radial profile",
                                         .model = DiscModel::shared_profile,
                                         .fit = refine_by_profile};

}  // namespace twincell::imaging
