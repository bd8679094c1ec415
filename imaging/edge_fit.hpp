#pragma once
/// \file
/// Centres from the edge alone: fast, and for discs that the model of an opaque disc does not describe.
///
/// On the ring |r - R| <= 2.5 px the darkness falls outward by s = -n . grad d; pixels vote for the edge's
/// place with the weight s. The circle (c, R) that minimises sum s (|p - c| - R)^2 follows from a linear fit,
/// done three times. Next to a contact the edge is cut short, which draws centres away: 0.05 to 0.2 px in
/// dense packings. When not to use: where the opaque fit (refine.hpp) holds and accuracy matters.

#include <vector>

#include "imaging/refine.hpp"

namespace twincell {

/// Fits each proposal for itself. Detection::score is 1 - (spread of the edge about the circle)^2 over that
/// of an edge anywhere on the ring. Pure.
Refined refine_by_edges(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px);

}  // namespace twincell
