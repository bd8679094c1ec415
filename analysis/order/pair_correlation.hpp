#pragma once
/// \file
/// Pair correlation function of the beads.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kPairCorrelationRange = 4;     ///< sigma, centre of the last bin of g(r)
inline constexpr double kPairCorrelationWidth = 0.05;  ///< sigma, width of a bin

/// Pair correlation function g(r): mean number of beads per area (3D: volume) at distance r from a bead,
/// divided by the mean number density of the other beads.
///
///     g(r) = sum over frames and reference beads of n(r) / (rho V_bin),   V_bin = pi (r_2^2 - r_1^2), in 3D
///     4 pi/3 (r_2^3 - r_1^3)
///
/// The centres of the bins are 0.05, 0.1, ..., 4 sigma, so that beads of diameter 1 in contact are in the
/// middle of a bin and not on the edge of two.
///
/// The bed ends at walls, at the plate and at its surface. A reference bead of a bin is therefore one that is
/// farther than the bin's outer radius from the edges of the bed's window (bed_window.hpp) with a margin of
/// half a bead diameter (border correction, Ripley 1988). rho = (N - 1)/V with the number N of beads in the
/// window and its area (volume) V, in each frame: a bead is no neighbour of its own, so that points without
/// interaction have g = 1 for every N. Results:
///
/// - g_r: [bins] mean over frames with reference beads; NaN in bins that no frame has
/// - g_r_low, g_r_high: [bins] ends of its 95 % interval, as a correlated series over frames
/// - g_r_distance: [bins] centres of the bins, sigma
/// - g_peak: scalar, the largest g(r)
/// - g_peak_distance: scalar, centre of its bin, sigma
///
/// B. D. Ripley, Statistical Inference for Spatial Processes, Cambridge 1988, ch. 3.
extern const ObservableEntry pair_correlation_observable;

}  // namespace twincell::analysis
