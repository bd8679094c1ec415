#pragma once
/// \file
/// What an observable is and what it gives.
///
/// To add one: NAME.hpp and NAME.cpp with a make_NAME in a room of analysis/, one row in the list of
/// observables.cpp, a test. Observables see frames and neighbours, never each other.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/neighbours/bond_order.hpp"
#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/progress.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// One measured quantity, or the reason why there is none.
struct Result {
  std::string name = {};
  std::vector<double> values = {};      ///< row-major; one for a scalar; NaN where an element has no value
  std::vector<std::size_t> shape = {};  ///< empty for a scalar
  std::string text = {};                ///< value of a result that is a word (phase)
  std::string unit = {};                ///< "sigma", "m g sigma", "1"
  std::size_t n = 0;                    ///< how many independent samples entered
  std::string n_of = {};                ///< samples of what: "cycles", "frames"
  std::optional<Interval> interval = {};
  std::string no_interval = {};      ///< why a value has no interval; empty if it has one
  std::string convention = {};       ///< choices that the definition leaves open, as made here
  std::string source = {};           ///< equation
  std::string absent = {};           ///< why there is no value; empty if there is one
  std::vector<double> of_runs = {};  ///< of a pooled scalar (pooling.hpp): the value of each run

  [[nodiscard]] bool present() const { return absent.empty(); }
  /// The scalar value; NaN if absent.
  [[nodiscard]] double value() const;
};

/// A result without a value.
Result absent_result(const std::string& name, const std::string& reason, const std::string& source);

/// `r` with the mean of `series`, its interval and its count; absent for that reason if the series is empty.
Result mean_of(const BlockAverage& series, Result r, const std::string& why_absent);
/// `r` with these values as an array of one axis and the count of those that are numbers; absent if none is.
Result array_of(const std::vector<double>& values, Result r, const std::string& why_absent);

/// Which of the readings of eq. B4 (s_b_of in phase_thresholds.hpp).
enum class SbForm { variance, about_rest, as_printed };
/// The form of that name. \throws ConfigError for another
SbForm s_b_named(const std::string& name);

/// Whose bonds make the order of a bead.
enum class NeighbourRule {
  cutoff,    ///< centres within AnalysisOptions::neighbour_cutoff
  delaunay,  ///< beads whose Voronoi cells share an edge (voronoi.hpp)
  voronoi,   ///< the same, each bond weighted by the length of that edge
};
/// The rule of that name. \throws ConfigError for another
NeighbourRule neighbour_rule_named(const std::string& name);

/// Choices for one analysis.
struct AnalysisOptions {
  std::int64_t discard_cycles = 0;         ///< cycles left out at the beginning
  std::int64_t cycles = 0;                 ///< N_f: cycles used after those; 0: all. s_c depends on it
  std::vector<std::int64_t> tracers = {};  ///< ids of the tracers; empty: as marked or chosen (tracers.hpp)
  std::optional<std::array<double, 2>> tracer_band = {};  ///< or all beads that begin at heights in [low,
                                                          ///< high] above the plate, sigma
  SbForm s_b = SbForm::variance;
  NeighbourRule neighbours = NeighbourRule::cutoff;
  std::optional<double> neighbour_cutoff;  ///< sigma; default 1.2, for experiments 1.3
  double cell_radius = kCellRadius;        ///< sigma; size of a Voronoi cell (voronoi.hpp)
  double field_cell = 2;                   ///< sigma; side of the cells in which displacements are averaged
  std::optional<double> rest_height;       ///< sigma; centre of mass of the bed at rest, above the plate
  std::vector<std::string> only;           ///< names of results wanted; empty: all

  /// Whether the result of that name is wanted.
  [[nodiscard]] bool wants(const std::string& name) const;
};

/// The cutoff of these options for this trajectory, sigma: touching beads are at 1, the next shell of a
/// square lattice at 1.414; 1.2 lies between, and 1.3 leaves room for the noise of positions from images
/// (0.03 sigma).
double neighbour_cutoff(const TrajectoryInfo& info, const AnalysisOptions& options);

/// What observables may know before the first frame.
struct AnalysisContext {
  const TrajectoryInfo& info;
  const AnalysisOptions& options;
  double cutoff;                     ///< neighbour cutoff, sigma
  std::vector<std::size_t> tracers;  ///< slots
  std::string tracer_choice;         ///< how they were chosen
  std::string no_tracers;            ///< why there are none, if so
  /// Mean height of the tracers above the plate when they were chosen; NaN unknown.
  double tracer_rest_height;
  /// The same of each tracer, beside `tracers`; NaN where it is not known.
  std::vector<double> tracer_rest_heights = {};
  /// Height of the bed's centre of mass above the plate at rest, sigma: as the options say, else of the first
  /// frame at phase 0 if the bed rests on the plate there (resting_height in centre_of_mass.hpp).
  std::optional<double> rest_height = {};
  std::string no_rest_height = {};  ///< why there is none, if so
};

/// How neighbours were found, in words.
std::string neighbour_rule_text(const AnalysisContext& context);

/// One frame with what is computed at most once for all observables.
class FrameView {
 public:
  FrameView(const Frame& frame, const AnalysisContext& context) : frame_(frame), context_(context) {}
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// By the rule of the analysis.
  [[nodiscard]] const Neighbours& neighbours() const;
  /// Of those neighbours.
  [[nodiscard]] const BondOrder& order() const;
  /// The Voronoi cells, whatever the rule. \pre the trajectory is planar
  [[nodiscard]] const VoronoiCells& cells() const;

 private:
  const Frame& frame_;
  const AnalysisContext& context_;
  mutable std::optional<Neighbours> neighbours_;
  mutable std::optional<BondOrder> order_;
  mutable std::optional<VoronoiCells> cells_;
};

/// An accumulator: sees each frame once, in order.
class Observable {
 public:
  virtual ~Observable() = default;
  virtual void add(const FrameView& view) = 0;
  [[nodiscard]] virtual std::vector<Result> results() const = 0;
};

/// All results of a trajectory in one pass; memory does not grow with the number of frames (series per cycle
/// excepted). \throws ConfigError for an unknown name in `only`, a negative discard or number of cycles, a
/// cutoff that is not positive, tracers that are not there; InputError for a
///         trajectory without frames
std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options = {},
                            Progress& progress = Progress::none());

/// Names that `analyze` can give, in order.
std::vector<std::string> result_names();

/// The result called `name`. \pre it is there
const Result& find_result(const std::vector<Result>& results, const std::string& name);
/// The result called `name`, or null.
const Result* seek_result(const std::vector<Result>& results, const std::string& name);

}  // namespace twincell
