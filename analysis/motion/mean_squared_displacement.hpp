#pragma once
/// \file
/// Mean squared displacement of the beads from cycle to cycle.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr std::size_t kLongestLag = 32;  ///< cycles

/// Mean squared displacement over whole cycles, at phase 0, relative to the centre of mass of the beads that
/// are present in both frames:
///
///     msd(m) = <|dr_i - <dr>|^2>,   dr_i = r_i(cycle j + m) - r_i(cycle j)
///
/// mean over beads and over all j. A free random walk gives 2 d D m T, a bed that convects steadily m^2 times
/// its value at one cycle. At equal phase, the motion with the plate cancels. Results:
///
/// - msd: [lags] sigma^2, for m = 1, 2 ... 32; NaN where no pair of cycles is that far apart
/// - msd_low, msd_high: [lags] ends of its 95 % interval, as a correlated series over j; the displacements of
///   overlapping pairs of cycles are correlated, so that a lag of m cycles needs a series of about 40 m
///   cycles (NaN before)
/// - msd_lag: [lags] m, cycles
///
/// In two dimensions d = 2 (x and z). Without drive phases all frames count, and m is in intervals between
/// frames ("frames").
extern const ObservableEntry mean_squared_displacement_observable;

}  // namespace twincell::analysis
