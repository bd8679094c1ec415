#pragma once
/// \file
/// Fit of plain discs that overlap in projection, as in two layers or in a cell that is deeper than a bead.
///
/// A disc k transmits the share 1 - a_k P_k of the light, with the blurred edge P of
/// ring_normal_equations.hpp, and discs behind each other transmit the product of their shares:
///     1 - c d = prod_k (1 - c a_k P_k),
/// with d the darkness of the picture and c its unit (PreprocessOptions::contrast). For opaque discs this is
/// their union. For discs that do not overlap it is the sum of picture_fit.hpp.
///
/// 1. Selection. Of all proposals, the one that explains most of the picture beyond those already taken is
///    taken, until none explains a tenth of a disc. A disc behind another explains its crescent.
/// 2. Fit. Centre, radius and darkness of each disc by Gauss-Newton steps, with the other discs fixed, and
///    the blur of all discs; the radii and the darkness have their scatter from disc to disc as priors. A
///    pixel is weighted by the transmission of the other discs there.
/// 3. Discs that explain less than a tenth of a whole disc are dropped. Where the picture is darker than the
///    discs, further discs are selected, and the fit is repeated. A disc that is larger than the others is
///    replaced by two, if these describe the picture better.
///
/// When not to use: for discs of one layer picture_fit.hpp is faster and as accurate, and finds discs of
/// which less is seen.

#include <vector>

#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// Detection::ring_share is the part of the rim that other discs do not hide; discs with less than a sixth
/// are dropped as unseen. Pure.
Refined refine_overlapping(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                           const RefineOptions& options);

inline constexpr Refiner kOverlappingRefiner{
    .word = "overlapping",
    .help = "fits plain discs that may overlap in projection, as in two layers",
    .model = DiscModel::plain,
    .fit = refine_overlapping,
    .layers = true};

}  // namespace twincell::imaging
