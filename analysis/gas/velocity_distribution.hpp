#pragma once
/// \file
/// Deviation of the velocity distribution from a Gaussian one.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Second Sonine coefficient of one velocity component c, relative to the mean velocity of the beads of the
/// frame:
///
///     a2 = <c^4>/(3 <c^2>^2) - 1
///
/// in each frame, mean over frames; 0 for a Gaussian distribution, -0.4 for a uniform one, positive with wide
/// tails. With N beads the expectation of <c^4>/<c^2>^2 of a Gaussian sample is 3 (N - 1)/(N + 1); this is
/// corrected for. Each frame has its own <c^2>, so that a temperature that varies over the cycle does not
/// count as a tail. Results:
///
/// - a2_x: horizontal velocity along x
/// - a2_z: vertical velocity
///
/// Absent without velocities, and where no frame has four beads that move. T. P. C. van Noije & M. H. Ernst,
/// Granular Matter 1, 57 (1998).
extern const ObservableEntry velocity_distribution_observable;

}  // namespace twincell::analysis
