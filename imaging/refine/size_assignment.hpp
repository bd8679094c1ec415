#pragma once
/// \file
/// Which of the proposals of several sizes are discs.
///
/// Rims of one size vote at the radius of another for places around the centre, a third as clearly, and where
/// little of a rim is seen more votes may meet there by chance. The picture tells: what is dark where a disc
/// should be may be a part of a larger disc, but where it is light there is none. With d the darkness, P the
/// blurred disc of ring_normal_equations.hpp and a the median of d in the outer half of the disc, what is
/// missing is
///     sum max(0, a P - d)^2 / sum (a P)^2 over the outer half and the rim, r > R/2,
/// less what noise alone adds. The inner half may have glare.

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell {

/// Share of a disc's darkness that is missing, in squares. 1 if nothing of it is seen. Pure.
/// \param blur_px standard deviation of the edge
double missing_share(const Prepared& image, const Proposal& disc, double blur_px, double noise_variance);

/// Of proposals that lie too near to each other for discs of one layer, the one of most evidence: its score
/// times R^2 times (1 - missing/0.01), a disc of which more is missing being none. Pure.
std::vector<Proposal> assign_sizes(const Prepared& image, const std::vector<Proposal>& proposals);

}  // namespace twincell
