#pragma once
/// \file
/// Circle fit: centres from the edge alone. It is fast, and it also serves discs that the model of an opaque
/// disc does not describe.
///
/// On the ring |r - R| <= 2.5 px (wider for large discs) the darkness falls outwards by s = -n . grad d. Each
/// pixel votes for the position of the edge with weight s. The circle (c, R) that minimises sum s (|p - c| -
/// R)^2 follows from a linear fit, which is repeated five times. Next to a contact the edge is cut short,
/// which displaces the centres: by 0.05 to 0.2 px in dense packings. When not to use: where the opaque fit
/// (picture_fit.hpp) applies and accuracy matters.

#include <vector>

#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// Fits each proposal separately, starting from the radius with which it was proposed. Detection::ring_share
/// is the share of the circle, 0 .. 1, on which an edge of the right sign is found. Detection::score, at most
/// 1, is 1 - (spread of the edge about the circle)^2 / (spread of an edge anywhere on the ring)^2. For discs
/// with a diameter above 50 px, which may be patterned inside, the score is ring_share, and a disc with a
/// ring_share below 0.4 is rejected. Pure.
/// \param radius_px > 1.5
Refined refine_by_edges(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                        const RefineOptions& options = {});

inline constexpr Refiner kEdgeRefiner{.word = "edges",
                                      .help = "fits a circle to the edge points of each disc",
                                      .model = DiscModel::circle,
                                      .fit = refine_by_edges};

}  // namespace twincell::imaging
