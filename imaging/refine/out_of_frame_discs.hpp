#pragma once
/// \file
/// Discs that lie beyond the frame and yet darken its border.
///
/// One whose centre is nearly a radius outside shows a sliver, too thin to be proposed. The fit takes it for
/// the neighbours' own and pushes them outwards, by up to 0.3 px where three beads touch it. Along each
/// border the residual picture r = d - T is compared with P, the picture of a disc, for centres from the
/// border out to where a disc is next to nothing: of darkness a = sum w r P / sum w P^2, known to 1/sqrt(sum
/// w P^2).

#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell {

/// Places beyond the frame to which the residual picture bears witness, clearest first; many of one disc.
/// Pure.
/// \param args as for the sums over rings
/// \param radius_px of the discs
/// \param deepest_px centres further beyond are not tried: their discs would be all blur
std::vector<Proposal> out_of_frame_discs(const RingArgs& args, double radius_px, double deepest_px);

}  // namespace twincell
