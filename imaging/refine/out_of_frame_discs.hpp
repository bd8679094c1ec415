#pragma once
/// \file
/// Discs whose centres are outside the frame and which darken its border.
///
/// A disc whose centre is nearly a radius outside shows only a sliver, which is too thin to be proposed. The
/// fit attributes the sliver to the neighbours and pushes them outwards, by up to 0.3 px where three beads
/// touch it. To find such discs, the residual picture r = d - T along each border is compared with P, the
/// picture of a disc, for centres from the border out to where a disc is nearly invisible. The fitted
/// darkness is a = sum w r P / sum w P^2, with standard deviation 1/sqrt(sum w P^2).

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell::imaging {

/// Proposes centres outside the frame for which the residual picture gives evidence, strongest evidence
/// first. One disc may give many proposals. Pure.
/// \param args as for the ring sums (ring_normal_equations.hpp)
/// \param radius_px radius of the discs
/// \param deepest_px largest distance of a centre from the border. Of a disc farther out only the blur would
///     be seen
/// \param least_darkness smallest fitted darkness of a disc
std::vector<Proposal> out_of_frame_discs(const RingArgs& args, double radius_px, double deepest_px,
                                         double least_darkness);

}  // namespace twincell::imaging
