#pragma once
/// \file
/// How far experiment and simulation are apart in each number, and what of that is known to come from
/// elsewhere.
///
/// With E the experiment, S the simulation and F the simulation as the experiment's camera and tracker would
/// have given it, over the same frames,
///
///     E - S = (F - S) + (E - F)
///
/// The first term is what camera and tracking do to the number. The second is like against like; it is held
/// against what else moves the number: the statistics of both sides, the choice of the tracers, the seed, and
/// the start with its defects.

#include <optional>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell {

/// A number with its standard error; the error is absent where nothing is known of it.
struct Measured {
  double value = 0;
  std::optional<double> error;
};

/// One number, both sides. All parts in the number's unit; absent parts were not determined.
struct Difference {
  std::size_t match = 0;  ///< index of the match
  std::string quantity, unit;
  Measured experiment, simulation;   ///< means over the match's runs
  std::optional<double> filmed;      ///< F
  std::optional<double> camera;      ///< F - S, of the run that was filmed
  std::optional<double> statistics;  ///< standard error of E - F (or E - S) from the intervals of both
  std::optional<double> seeds;       ///< largest standard deviation between simulations of one start
  std::size_t seed_runs = 0;         ///< simulations of that start
  std::optional<double> tracers;     ///< standard deviation of E - S over three lines of tracers
  std::optional<double> defects;  ///< largest difference between the means of simulations of different starts

  [[nodiscard]] double difference() const { return experiment.value - simulation.value; }
  /// E - F, or E - S where nothing was filmed.
  [[nodiscard]] double remainder() const { return experiment.value - filmed.value_or(simulation.value); }
  /// The seeds' share in the error: their standard deviation s, as that of E - S, s sqrt(1 + 1/n), and
  /// widened by t/1.96 (Student, n - 1 degrees of freedom) for what n runs do not show of s. 7.9 s for two
  /// runs, 2.5 s for three, 1.2 s for ten.
  [[nodiscard]] std::optional<double> seed_error() const;
  /// Statistics, seeds and tracers in quadrature, as far as they are known; absent if none is.
  [[nodiscard]] std::optional<double> error() const;
  /// remainder / error; absent without an error.
  [[nodiscard]] std::optional<double> in_errors() const;
  /// One sentence: what the difference is attributed to.
  [[nodiscard]] std::string attribution() const;
};

/// What was done beyond the runs of a comparison to see where differences come from.
struct Checks {
  /// A simulation, the same frames of it as seen (S) and as filmed and tracked (F).
  struct Filmed {
    std::size_t run = 0;  ///< index of the simulation
    std::vector<Result> seen, filmed;
    std::string camera;  ///< which camera, in words
  };
  /// A result on three lines of tracers: one sigma below mid-height, at it, one above.
  struct TracerLines {
    std::size_t run = 0;
    std::string quantity;
    std::vector<double> values;
  };
  std::vector<Filmed> filmed;
  std::vector<TracerLines> tracers;
};

/// s_b and s_c on these lines; without one that is absent on any of them.
std::vector<Checks::TracerLines> tracer_lines(const TrajectorySource& trajectory, std::size_t run,
                                              const AnalysisOptions& options);

/// The differences of every match with both sides, in every scalar that both have.
std::vector<Difference> find_differences(const std::vector<Run>& runs, const std::vector<Match>& matches,
                                         const Checks& checks = {});

/// A table for a terminal.
std::string differences_text(const std::vector<Difference>& differences, const std::vector<Match>& matches);

}  // namespace twincell
