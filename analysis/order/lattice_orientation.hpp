#pragma once
/// \file
/// Orientation of the lattice in the cell: A, B, or between.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// A bead has orientation A or B if its lattice_angle is within this many degrees of 0 or 30. For random
/// lattice directions one third is A, one third B, and one third neither.
inline constexpr double kOrientationWidth = 10;

/// Whole periods, in degrees, by which a mean of unwrapped lattice angles lies outside the range of
/// lattice_angle, -15 to below 45.
double turns_of_lattice(double degrees);

/// Orientation of the lattice with the neighbour rule of the analysis. Results:
///
/// - ordered_fraction: scalar, share of the enclosed beads with psi6 > kOrdered, mean over frames
/// - orientation: scalar, lattice_angle of the complex psi_6 summed over the ordered beads of all frames,
/// degrees. Its interval is that of the component of the sum across its direction, over frames. Absent if the
/// sum is shorter than 4 standard errors; without an error over frames, shorter than sqrt(8 n) of n ordered
/// beads of a frame: the lattices then have no common direction
/// - orientation_a, orientation_b: scalars, shares of the ordered beads with orientation A and B, frame mean
/// - orientation_beads: [n_beads] lattice_angle of each bead in the last frame, degrees
///
/// Orientation A has close-packed rows along the floor (0 degrees), B along the side walls (30 degrees):
/// Fortini & Huang 2015, Fig. 2. Absent in a cell that is not planar.
extern const ObservableEntry orientation_observable;

}  // namespace twincell::analysis
