#pragma once
/// \file
/// Runs of an experiment and of its simulation, placed by drive strength and put beside each other.

#include <optional>
#include <string>
#include <vector>

#include "analysis/observable.hpp"
#include "analysis/order.hpp"
#include "analysis/phase_thresholds.hpp"

namespace twincell {

enum class Side { experiment, simulation };
/// "experiment", "simulation".
std::string side_name(Side side);

/// One moment of a run, for a picture.
struct Snapshot {
  Frame frame;
  BondOrder order;
  double plate = 0;  ///< height of the plate, sigma; the box's floor if it is not known
};

/// One trajectory, analysed: a point of the phase diagram.
struct Run {
  Side side = Side::simulation;
  std::string name;         ///< file name
  double gamma = 0;         ///< A omega^2/g
  double k_m = 0;           ///< A^2 omega^2/(sigma g)
  double omega = 0;         ///< 1/t0
  double n_l = 0;           ///< N_l sigma = N sigma/L_x with N the beads of the first frame
  std::size_t n_beads = 0;  ///< N
  std::size_t n_frames = 0;
  BedPhase phase = BedPhase::undetermined;
  std::vector<Result> results;
  double cutoff = 0;  ///< neighbour cutoff of the bond order, sigma
  Box box;
  std::vector<double> radius;  ///< per slot, sigma; empty: 1/2
  Snapshot first, last;        ///< first and last frame at phase 0
};

/// Analyses a trajectory and places it. \throws InputError if it has no drive; otherwise as `analyze`
Run analyze_run(const TrajectorySource& trajectory, Side side, const AnalysisOptions& options = {},
                Progress& progress = Progress::none());

/// Runs of both sides at one drive strength, as indices.
struct Match {
  double gamma = 0;  ///< mean of the members
  std::vector<std::size_t> experiments;
  std::vector<std::size_t> simulations;
};

/// Gathers runs whose Gamma agree within `tolerance` relative (to the smallest of the group) and whose N_l
/// agree within 10 %, in order of Gamma. A group may have members on one side only.
std::vector<Match> match_runs(const std::vector<Run>& runs, double tolerance = 0.02);

/// Phase of several runs (seeds) together: theirs if they agree, else undetermined. Undetermined for none.
BedPhase common_phase(const std::vector<Run>& runs, const std::vector<std::size_t>& members);

/// What a reader wants to know of a match: "same", "differ", "only experiment", "only simulation",
/// "undetermined".
std::string verdict(const std::vector<Run>& runs, const Match& match);

}  // namespace twincell
