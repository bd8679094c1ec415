#pragma once
/// \file
/// How a number depends on the unit of length and on the amplitude of the drive.

#include <string>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// The power of the bead diameter sigma in a unit, at fixed mass and gravity: t0 = sqrt(sigma/g) counts 1/2.
/// A scale of s pixels per sigma that is wrong by ds therefore changes a number X of this unit by
/// -power X ds/s. "sigma^2" gives 2, "sigma/t0" 1/2, "m g sigma" 1, "1/sigma" -1, "cycles" 0.
/// \param unit words with optional exponents; those after "/" divide, and "per" ends the unit ("sigma per
/// cycle"); other words have no length
double length_power(const std::string& unit);

/// The power of the lengths in the pictures in a result: that of its unit, and -dimension of a filling, which
/// has none, because the beads keep their size of one sigma while the volume around them is measured.
double length_power(const Result& result, int dimension);
/// The power of the amplitude of the drive in a result: an amplitude that is wrong by dA changes X by
/// power X dA/A.
double amplitude_power(const Result& result);

}  // namespace twincell::analysis
