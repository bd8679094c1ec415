#pragma once
/// \file
/// Differences between experiment and simulation in each number, and their attribution to known causes.
///
/// Let E be the experiment, S the simulation, and F the same frames of the simulation as filmed and tracked
/// like the experiment (virtual experiment). Then
///
///     E - S = (F - S) + (E - F)
///
/// The first term is the effect of camera and tracking on the number. The second term compares like with
/// like. It is compared with the other causes of scatter: the statistics of both sides, the choice of the
/// tracers, the seed, the error of the scale in which the experiment was measured, and the start with its
/// defects.

#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// A number with its standard error; the error is absent if unknown.
struct Measured {
  double value = 0;
  std::optional<double> error;
};

/// One number on both sides. All values have the unit of the number; absent values were not determined. An
/// orientation of the simulation is the one nearest to the experiment's, which may be beyond -15 … 45
/// degrees.
struct Difference {
  std::size_t match = 0;  ///< index of the match
  std::string quantity, unit;
  Measured experiment, simulation;    ///< means over the match's runs
  std::optional<double> filmed;       ///< F
  std::optional<double> camera;       ///< F - S, from the run that was filmed
  std::optional<double> statistics;   ///< standard error of E - F (or E - S) from the intervals of both
  std::optional<Side> without_error;  ///< the side whose error is missing in error(), if one is
  std::optional<double> seeds;        ///< largest standard deviation between simulations of one start
  std::size_t seed_runs = 0;          ///< simulations of that start
  std::optional<double> tracers;      ///< standard deviation of E - S over three lines of tracers
  std::optional<double> scale;        ///< error of E by the stated error of the scale of its pictures
  std::optional<double> drive;        ///< error of E by that of the amplitude of the drive in the film
  std::optional<double> defects;  ///< largest difference between the means of simulations of different starts
  double significant = 2;  ///< number of errors above which it is real, set by find_differences for all

  [[nodiscard]] double difference() const { return experiment.value - simulation.value; }
  /// E - F, or E - S if nothing was filmed.
  [[nodiscard]] double remainder() const { return experiment.value - filmed.value_or(simulation.value); }
  /// Contribution of the seeds to the error of E - S: s sqrt(1 + 1/n) with s the standard deviation between n
  /// seeds, widened by t/1.96 (Student's t, n - 1 degrees of freedom) because n runs give an uncertain s. The
  /// result is 7.9 s for two runs, 2.5 s for three, 1.2 s for ten.
  [[nodiscard]] std::optional<double> seed_error() const;
  /// Statistics, seeds, tracers, scale and drive added in quadrature, as far as they are known; absent if
  /// none of the first three is known.
  [[nodiscard]] std::optional<double> error() const;
  /// remainder / error; absent without an error, and if one side has none.
  [[nodiscard]] std::optional<double> in_errors() const;
  /// Whether the remainder exceeds `significant` errors.
  [[nodiscard]] bool is_beyond_error() const;
  /// Whether E is between S and F in spite of that: a smaller effect of the camera explains it.
  [[nodiscard]] bool is_by_camera() const;
  /// Whether the remainder exceeds its errors and the difference between starts with other defects, and
  /// camera and tracking do not cause all of it.
  [[nodiscard]] bool is_real() const;
  /// The share of the difference that camera and tracking cause, if it is above one half.
  [[nodiscard]] std::optional<double> camera_share() const;
  /// The cause to which the difference is attributed, in one sentence.
  [[nodiscard]] std::string attribution() const;
};

/// Additional analyses that show where the differences of a comparison come from.
struct Checks {
  /// The results of the same frames of a simulation directly (S) and as filmed and tracked (F).
  struct Filmed {
    std::size_t run = 0;  ///< index of the simulation
    std::vector<Result> seen, filmed;
    std::string camera;  ///< which camera, in words
  };
  /// A result for three lines of tracers: one sigma below mid-height, at mid-height, one sigma above.
  struct TracerLines {
    std::size_t run = 0;
    std::string quantity;
    std::vector<double> values;
  };
  std::vector<Filmed> filmed;
  std::vector<TracerLines> tracers;
};

/// s_b and s_c of run number `run` for these three lines. A result that is absent for any line is left out.
std::vector<Checks::TracerLines> tracer_lines(const TrajectorySource& trajectory, std::size_t run,
                                              const AnalysisOptions& options);

/// Expected share of numbers that are called different although they are not.
inline constexpr double kFalseShare = 0.05;

/// The differences of every match that has both sides, for every scalar that both sides have. A number that
/// repeats another one of its match on both sides (s_b_variance, where s_b is it) is left out. Of many
/// numbers some exceed two errors by chance, so that the limit `significant` is that of Benjamini & Hochberg
/// (J. R. Stat. Soc. B 57, 289 (1995)): of m numbers with known errors, with two-sided probabilities p_1 <=
/// p_2 … of a normal law, those up to the largest k with p_k <= kFalseShare k/m are real; at least two
/// errors.
std::vector<Difference> find_differences(const std::vector<Run>& runs, const std::vector<Match>& matches,
                                         const Checks& checks = {});

/// The differences as a table for a terminal.
std::string differences_text(const std::vector<Difference>& differences, const std::vector<Match>& matches);

/// As differences_text, only the real ones, each in a line of at most 100 columns with its size in errors;
/// then what remains open for all of them, and the number of the others. Empty if there are no differences.
std::string real_differences_text(const std::vector<Difference>& differences,
                                  const std::vector<Match>& matches);

}  // namespace twincell::analysis
