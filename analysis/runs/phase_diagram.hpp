#pragma once
/// \file
/// Phase diagram: runs of experiment and simulation, ordered and matched by drive strength.

#include <optional>
#include <string>
#include <vector>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/motion/snapshots.hpp"
#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Origin of a run.
enum class Side { experiment, simulation };
/// Name of a side: "experiment", "simulation".
std::string side_name(Side side);

/// Position of the cell in a run's camera frames: the point (x, z) of the cell is at (origin_x + s x,
/// origin_y - s z) px, with s = pixels_per_sigma.
struct PictureFrame {
  double pixels_per_sigma = 0;
  double origin_x = 0,
         origin_y = 0;        ///< px; position of (0, 0); the centre of a pixel has integer coordinates
  int width = 0, height = 0;  ///< px
};

/// Data for displaying a run. Filled on request, because frames are large.
struct Show {
  std::vector<Snapshot> snapshots;
  std::vector<std::string>
      pictures;  ///< JPEG or PNG of each snapshot, empty string if not kept; or no entries at all
  std::optional<PictureFrame> camera;
};

/// One analysed trajectory: a point of the phase diagram.
struct Run {
  Side side = Side::simulation;
  std::string name;         ///< file name
  std::string start;        ///< kind of start of a simulation, as in its scene; empty: unknown
  double gamma = 0;         ///< A omega^2/g
  double k_m = 0;           ///< A^2 omega^2/(sigma g)
  double omega = 0;         ///< 1/t0
  double n_l = 0;           ///< N_l sigma = N sigma/L_x with N the beads of the first frame
  std::size_t n_beads = 0;  ///< N
  std::size_t n_frames = 0;
  std::optional<double> scale_error;  ///< relative standard error of the pixels per sigma, if it is stated
  /// Relative standard error of the amplitude A of the drive in the film, without that of the scale, if it
  /// was measured there.
  std::optional<double> amplitude_error;
  int phases_per_cycle = 0;  ///< N_k; 0: not phase-locked
  BedPhase phase = BedPhase::undetermined;
  std::vector<Result> results;
  double cutoff = 0;  ///< neighbour cutoff of the bond order, sigma
  Box box;
  std::vector<double> radius;        ///< per slot, sigma; empty: 1/2
  std::vector<std::size_t> tracers;  ///< slots
  Snapshot first, last;              ///< first and last frame at phase 0
  Show show;

  /// Relative standard error of A/sigma by the film and its scale; absent if A was not measured. That of
  /// Gamma is the same, those of K_m and S = A^2 omega^2/(sigma g) are twice as large.
  [[nodiscard]] std::optional<double> drive_error() const;
};

/// Analyses a trajectory and places it in the phase diagram.
/// \throws InputError if it has no drive; otherwise as `analyze`
Run analyze_run(const TrajectorySource& trajectory, Side side, const AnalysisOptions& options = {},
                Progress& progress = Progress::none());

/// Runs of both sides at one drive strength, as indices into the list of runs.
struct Match {
  double gamma = 0;  ///< mean of the members
  double n_l = 0;    ///< mean of the members
  std::vector<std::size_t> experiments;
  std::vector<std::size_t> simulations;
};

/// Groups runs whose Gamma agree within the relative `tolerance` (relative to the smallest Gamma of the
/// group) and whose N_l agree within 10 %, in order of Gamma. A group may have members on one side only.
std::vector<Match> match_runs(const std::vector<Run>& runs, double tolerance = 0.02);

/// Whether two numbers of layers count as the same height: |a - b| <= a/10.
bool same_height(double a, double b);
/// The different heights of the matches, N_l, in ascending order.
std::vector<double> heights_of(const std::vector<Match>& matches);
/// "Gamma 2.8"; with `height`, "Gamma 2.8, N_l = 6".
std::string condition_text(const Match& match, bool height);

/// Common phase of several runs (seeds); undetermined if they disagree or if there are no runs.
BedPhase common_phase(const std::vector<Run>& runs, const std::vector<std::size_t>& members);

}  // namespace twincell::analysis
