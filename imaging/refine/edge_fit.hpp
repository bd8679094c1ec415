#pragma once
/// \file
/// Centres from the edge alone: fast, and for discs that the model of an opaque disc does not describe.
///
/// On the ring |r - R| <= 2.5 px the darkness falls outward by s = -n . grad d; pixels vote for the edge's
/// place with the weight s. The circle (c, R) that minimises sum s (|p - c| - R)^2 follows from a linear fit,
/// done three times. Next to a contact the edge is cut short, which draws centres away: 0.05 to 0.2 px in
/// dense packings. When not to use: where the opaque fit (picture_fit.hpp) holds and accuracy matters.

#include <vector>

#include "imaging/refine/refiner.hpp"

namespace twincell {

/// Fits each proposal for itself, by the radius that it was sought with. Detection::ring_share is the share
/// of the circle on which an edge of the right sign lies. Detection::score is 1 - (spread of the edge about
/// the circle)^2 over that of an edge anywhere on the ring; for discs of more than 50 px, which may be
/// patterned inside, it is ring_share, and less than 0.4 of a circle is none. Pure.
Refined refine_by_edges(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                        const RefineOptions& options = {});

inline constexpr Refiner kEdgeRefiner{
    .word = "edges", .help = "circles through the edges", .model = DiscModel::circle, .fit = refine_by_edges};

}  // namespace twincell
