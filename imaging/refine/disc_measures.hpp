#pragma once
/// \file
/// What can be read off a disc's own pixels once its place is known.

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell {

/// Sets interior (median darkness inside R/2), and over the whole disc mass, raw_mass, signal, size and ecc:
/// brightness and shape as trackpy's users know them.
void measure_disc(const Prepared& image, Detection& disc);

/// Median of nine pixels inside R/2: enough to tell a disc from a gap. Outside the frame 1: the rim will
/// speak.
double rough_interior(const Prepared& image, const Detection& disc);

/// Whether its centre lies in a dark region too large for a bead.
bool in_wall(const Prepared& image, const Detection& disc);

}  // namespace twincell
