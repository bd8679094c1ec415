#pragma once
/// \file
/// Pooling: several runs of one bed that differ by chance alone (seeds, repeats of an experiment) as one
/// measurement.

#include <functional>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// The pooled results of all runs, in the order of the first run.
///
/// - Numbers: the mean over the runs that have the number. Each run has the same weight, because the
///   independent samples are the beds, not the cycles. s_b, s_j and s_c are root mean squares and are pooled
///   as squares. Counts (slips, slip_directions) are added. The orientation is the mean angle, with a period
///   of 60 degrees
/// - Intervals: the 95 % interval of a mean of independent runs, by Student's t for 2 to 5 runs and by the
///   studentised bootstrap for 6 or more. It is widened, if necessary, to the combined own intervals of the
///   runs (over their tracers or cycles). Without a slip in any run, the interval of p_s is exact binomial
///   over the trials of all runs
/// - Words (phase, drift): the word of most runs, with the counts; absent if two words tie
/// - Arrays: pooled element by element, up to the end of the shortest. Elements of sparse profiles
///   (NamedResult::along) are matched by their abscissas. NAME_low and NAME_high of an array NAME are the
///   ends of the interval of each pooled element, as for numbers. Values of single beads are not pooled,
///   because the beads of different runs do not correspond
///
/// `n` is the number of runs, and `of_runs` has the value of each run (NaN if a run has none).
/// \param only names of the requested results; empty: all
/// \pre runs is not empty
/// \throws ConfigError if one run repeats another (repeated_runs)
std::vector<Result> pool(const std::vector<std::vector<Result>>& runs,
                         const std::vector<std::string>& only = {});

/// The results that every run must have so that `only` can be pooled: those, the abscissas of profiles, and
/// the arrays and both ends of intervals.
std::vector<std::string> needed_to_pool(const std::vector<std::string>& only);

/// The results of one run, or the pooled results of several.
/// \param analyse analyses the run of that index with the given options, which request what pooling needs
/// \pre runs > 0
/// \throws as pool()
std::vector<Result> analyze_together(
    std::size_t runs, const AnalysisOptions& options,
    const std::function<std::vector<Result>(std::size_t, const AnalysisOptions&)>& analyse);

/// For each run, the index of the first run whose results are identical to the last bit, or its own index if
/// there is no such run. Identical results mean that the same run was given twice, or that a seed has no
/// effect. Different runs may agree by chance in counts and ratios of counts; runs therefore count as
/// identical only if they share at least one number that is not a fraction of small integers.
std::vector<std::size_t> repeated_runs(const std::vector<std::vector<Result>>& runs);

/// First and last frame of a run, by which two files with the same run are recognised.
struct RunEnds {
  explicit RunEnds(const TrajectorySource& run);
  /// Whether both runs have equally many frames, at least one, and their first and last frames agree in every
  /// coordinate.
  [[nodiscard]] bool of_same_run(const RunEnds& other) const;

  std::size_t n_frames;
  Frame first, last;
};

/// Rejects runs that cannot be pooled.
/// \throws ConfigError with the names of two runs and the property in which they differ: source, dimension,
/// Gamma, omega or width (2 %), number of beads (10 %), phases per cycle, kind of start, and, where the
/// provenance of both contains a scene, a key of its tables contact, beads or cell (bed_keys); or if both
/// contain the same run, bead for bead, or a frame in common, except their first ones
/// \pre every trajectory has frames
/// \returns a sentence for each run whose scene is unknown while that of another is known: what was not
/// compared
std::vector<std::string> require_one_condition(const std::vector<const TrajectorySource*>& trajectories);

}  // namespace twincell::analysis
