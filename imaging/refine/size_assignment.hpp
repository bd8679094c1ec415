#pragma once
/// \file
/// Size assignment: which of the proposals of several sizes are discs.
///
/// Rims of one size also produce votes at the radius of another size, at positions around the centre, a third
/// as strong. Where little of a rim is visible, more votes may coincide by chance. The picture decides: a
/// dark area may belong to a larger disc, but a bright area excludes a disc. With d the darkness, P the
/// blurred disc of ring_normal_equations.hpp and a the median of d in the outer half of the disc, the missing
/// share is
///     sum max(0, a P - d)^2 / sum (a P)^2 over the outer half and the rim, r > R/2,
/// less the contribution of noise. The inner half is excluded because it may have glare.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging {

/// Share of a disc's squared darkness that is missing (see above). 1 if no pixel of it is visible. Pure.
/// \param blur_px standard deviation of the edge
double missing_share(const Prepared& image, const Proposal& disc, double blur_px, double noise_variance);

/// Among proposals too close to each other for discs of one layer, keeps the one with the most evidence:
/// score times R^2 times (1 - missing/0.01). A proposal with a larger missing share has no evidence. Pure.
std::vector<Proposal> assign_sizes(const Prepared& image, const std::vector<Proposal>& proposals);

}  // namespace twincell::imaging
