#pragma once
/// \file
/// Runs of an experiment and of its simulation, placed by drive strength and put beside each other.

#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/phase_thresholds.hpp"
#include "analysis/motion/snapshots.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/order/order.hpp"

namespace twincell {

enum class Side { experiment, simulation };
/// "experiment", "simulation".
std::string side_name(Side side);

/// Where a run's camera frames show its cell: (x, z) of the cell lies at (origin_x + s x, origin_y - s z) px.
struct PictureFrame {
  double pixels_per_sigma = 0;
  double origin_x = 0, origin_y = 0;  ///< px; of (0, 0): pixel (0, 0) has its centre there
  int width = 0, height = 0;          ///< px
};

/// What a reader sees of a run. Filled on request: frames are large.
struct Show {
  std::vector<Snapshot> moments;
  std::vector<std::string> pictures;  ///< PNG of each moment, empty where none is kept; or empty
  std::optional<PictureFrame> camera;
};

/// One trajectory, analysed: a point of the phase diagram.
struct Run {
  Side side = Side::simulation;
  std::string name;         ///< file name
  std::string start;        ///< kind of start of a simulation, as in its scene; empty: not known
  double gamma = 0;         ///< A omega^2/g
  double k_m = 0;           ///< A^2 omega^2/(sigma g)
  double omega = 0;         ///< 1/t0
  double n_l = 0;           ///< N_l sigma = N sigma/L_x with N the beads of the first frame
  std::size_t n_beads = 0;  ///< N
  std::size_t n_frames = 0;
  int phases_per_cycle = 0;  ///< N_k; 0: not phase-locked
  BedPhase phase = BedPhase::undetermined;
  std::vector<Result> results;
  double cutoff = 0;  ///< neighbour cutoff of the bond order, sigma
  Box box;
  std::vector<double> radius;        ///< per slot, sigma; empty: 1/2
  std::vector<std::size_t> tracers;  ///< slots
  Snapshot first, last;              ///< first and last frame at phase 0
  Show show;
};

/// Kind of start of a simulation, by the scene that it keeps in its provenance; empty: not known.
std::string start_of(const TrajectoryInfo& info);

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
