#pragma once
/// \file
/// Several runs of one bed that differ by chance alone (seeds, repeats of an experiment), as one measurement.

#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// The results of all runs together, in the order of the first.
///
/// A number is the mean over the runs that have it, each counting once: beds are what differs by chance, not
/// cycles. s_b and s_c are means of squares and pooled as squares; counts (slips, slip_directions) are added;
/// the orientation is the mean angle of a lattice that 60 degrees bring back. The 95 % interval is that of a
/// mean of independent runs: Student's t over 2 to 5 runs, bootstrap (studentised) over 6 and more, and not
/// narrower than the runs' own intervals (over their tracers or cycles) allow when they are taken together.
/// No slip in any run: exact binomial over the trials of all. A word (phase, drift) is that of most runs,
/// with the counts; absent if two words tie. Arrays are pooled element by element, those of different length
/// up to the end of the shortest; values of single beads are not pooled, for they are other beads in each
/// run. `n` counts runs, `of_runs` holds the value of each (NaN where a run has none). \pre runs is not empty
/// \throws ConfigError if one run repeats another (repeated_runs)
std::vector<Result> pool(const std::vector<std::vector<Result>>& runs);

/// For each run the index of the first one whose results are the same to the last bit, itself if none is: the
/// same run given twice, or a seed that changes nothing. Runs may agree by chance in counts and in shares of
/// counts, so that only runs with a number that is no fraction of small integers are told to be the same.
std::vector<std::size_t> repeated_runs(const std::vector<std::vector<Result>>& runs);

/// Refuses runs that cannot be pooled. \throws ConfigError naming two of them and what tells them apart:
/// source, dimension, Gamma, omega or width (2 %), number of beads (10 %), phases per cycle, kind of start;
/// or that both hold the same run, bead for bead \pre every trajectory has frames
void require_one_condition(const std::vector<const TrajectorySource*>& trajectories);

}  // namespace twincell
