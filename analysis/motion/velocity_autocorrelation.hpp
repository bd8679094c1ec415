#pragma once
/// \file
/// Velocity autocorrelation function.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr std::size_t kLongestVelocityLag = 32;  ///< frames

/// Normalised velocity autocorrelation function
///
///     C(t) = <v'_i(s) . v'_i(s + t)>/<(v'_i(s)^2 + v'_i(s + t)^2)/2>
///
/// with v' relative to the mean velocity of the frame, mean over the beads that are present in both frames
/// and over all frames s. The denominator makes |C| <= 1 for any bed, also for one whose temperature varies
/// over the cycle. cos(omega t) for an oscillation, exp(-gamma t) for Brownian motion with friction. The lags
/// are multiples of the time between the first two frames; frames at other times do not count. Results:
///
/// - vacf: [lags] C, for lags of 0 to 32 frames; NaN where no frames are that far apart
/// - vacf_low, vacf_high: [lags] ends of its 95 % interval, as a correlated series over frames; NaN at lag 0,
///   where C = 1 by definition
/// - vacf_lag: [lags] t, t0
///
/// Absent without velocities. Allen & Tildesley, Computer Simulation of Liquids, sec. 2.7.
extern const ObservableEntry velocity_autocorrelation_observable;

}  // namespace twincell::analysis
