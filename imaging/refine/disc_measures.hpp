#pragma once
/// \file
/// Measures of a disc from its own pixels, once its position is known.

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging {

/// Sets interior (median darkness inside R/2) and, over the whole disc, mass, raw_mass, signal, size and ecc:
/// the brightness and shape measures of trackpy.
void measure_disc(const Prepared& image, Detection& disc);

/// Median of nine pixels inside R/2, which is enough to distinguish a disc from a gap. 1 if all of them are
/// outside the frame; the fit of the rim then decides.
double rough_interior(const Prepared& image, const Detection& disc);
/// The smallest one that a refiner accepts of a proposal.
inline constexpr double kMinInterior = 0.3;
/// The same where pale discs are kept (RefineOptions::pale).
inline constexpr double kMinPaleInterior = 0.15;

/// Whether the centre of the disc is in a dark region that is too large for a bead.
bool in_wall(const Prepared& image, const Detection& disc);

}  // namespace twincell::imaging
