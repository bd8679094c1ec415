#pragma once
/// \file
/// Observables and their results.
///
/// To add an observable, write NAME.hpp and NAME.cpp, which define NAME_observable, in a room of analysis/,
/// add its word to the list in observables.cpp, and write a test. Observables use frames and neighbours,
/// never each other.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/choice.hpp"
#include "core/progress.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// One measured quantity, or the reason why it is absent.
struct Result {
  std::string name = {};
  std::vector<double> values = {};  ///< row-major; one value for a scalar; NaN where an element has no value
  std::vector<std::size_t> shape = {};  ///< empty for a scalar
  std::string text = {};                ///< value of a result that is a word, such as phase
  std::string unit = {};                ///< "sigma", "m g sigma", "1"
  std::size_t n = 0;                    ///< number of samples used
  std::string n_of = {};                ///< kind of the samples: "cycles", "frames"
  std::optional<Interval> interval = {};
  std::string no_interval = {};      ///< why a value has no interval; empty if it has one
  std::string convention = {};       ///< choices made here that the definition leaves open
  std::string source = {};           ///< paper and equation
  std::string absent = {};           ///< why there is no value; empty if there is a value
  std::vector<double> of_runs = {};  ///< for a pooled scalar (pooling.hpp): the value of each run

  [[nodiscard]] bool present() const { return absent.empty(); }
  /// The scalar value; NaN if absent.
  [[nodiscard]] double value() const;
};

/// A result without a value, with the reason.
Result absent_result(const std::string& name, const std::string& reason, const std::string& source);

/// `r` with the mean of `series`, its interval and its count; absent with the reason `why_absent` if the
/// series is empty.
Result mean_of(const SeriesAverage& series, Result r, const std::string& why_absent);
/// `r` with `values` as a one-dimensional array and the count of finite values; absent with the reason
/// `why_absent` if no value is finite.
Result array_of(const std::vector<double>& values, Result r, const std::string& why_absent);

/// Readings of eq. B4 (s_b_of in bouncing_measure.hpp).
enum class SbForm { variance, about_rest, as_printed };
/// All forms with their words.
inline constexpr std::array kSbForms = {
    Choice<SbForm>{SbForm::variance, "variance", "standard deviation over the phases"},
    Choice<SbForm>{SbForm::about_rest, "about_rest", "rms about the height at rest"},
    Choice<SbForm>{SbForm::as_printed, "as_printed", "rms of the height"}};
/// The form with this name.
/// \throws ConfigError for an unknown name
SbForm s_b_named(const std::string& name);

/// Definition of the neighbours that enter a bead's bond order.
enum class NeighbourRule {
  cutoff,    ///< centres within AnalysisOptions::neighbour_cutoff
  delaunay,  ///< beads whose Voronoi cells share an edge (voronoi.hpp)
  voronoi,   ///< the same, each bond weighted by the length of that edge
};
/// All rules with their words.
inline constexpr std::array kNeighbourRules = {
    Choice<NeighbourRule>{NeighbourRule::cutoff, "cutoff", "beads whose centres are within the cutoff"},
    Choice<NeighbourRule>{NeighbourRule::delaunay, "delaunay", "beads whose Voronoi cells share an edge"},
    Choice<NeighbourRule>{NeighbourRule::voronoi, "voronoi",
                          "the same, each bond weighted by the length of that edge"}};
/// The rule with this name.
/// \throws ConfigError for an unknown name
NeighbourRule neighbour_rule_named(const std::string& name);

/// Options of one analysis.
struct AnalysisOptions {
  std::int64_t discard_cycles = 0;  ///< number of cycles left out at the beginning
  std::int64_t cycles = 0;          ///< N_f: number of cycles used after those; 0: all. s_c depends on it
  std::vector<std::int64_t> tracers = {};  ///< ids of the tracers; empty: as marked or chosen (tracers.hpp)
  /// Instead of `tracers`: all beads whose initial heights above the plate are in [low, high], sigma.
  std::optional<std::array<double, 2>> tracer_band = {};
  SbForm s_b = SbForm::variance;
  NeighbourRule neighbours = NeighbourRule::cutoff;
  std::optional<double> neighbour_cutoff;  ///< sigma; default 1.2, for experiments 1.3
  double cell_radius = kCellRadius;        ///< sigma; radius of a Voronoi cell (voronoi.hpp)
  double field_cell = 2;                   ///< sigma; side of the cells in which displacements are averaged
  std::optional<double> rest_height;  ///< sigma; height of the resting bed's centre of mass above the plate
  std::string rest_height_is = "as given";  ///< where rest_height comes from, for conventions
  std::vector<std::string> only;            ///< names of the requested results; empty: all

  /// Whether the result `name` is requested.
  [[nodiscard]] bool wants(const std::string& name) const;
};

/// Neighbour cutoff for this trajectory, sigma: the cutoff of the options, else 1.3 for experiments and 1.2
/// for simulations. Touching beads are 1 apart, and the next shell of a square lattice is at 1.414. The value
/// 1.2 is between the two; 1.3 leaves room for the noise of positions from images (0.03 sigma).
double neighbour_cutoff(const TrajectoryInfo& info, const AnalysisOptions& options);

/// Data that are available to observables before the first frame.
struct AnalysisContext {
  const TrajectoryInfo& info;
  const AnalysisOptions& options;
  double cutoff;                     ///< neighbour cutoff, sigma
  std::vector<std::size_t> tracers;  ///< slots
  std::string tracer_choice;         ///< how the tracers were chosen
  std::string no_tracers;            ///< why there are no tracers; empty if there are any
  /// Mean height of the tracers above the plate in the frame in which they were chosen, sigma; NaN if
  /// unknown, or if the bed does not lie at rest there.
  double tracer_rest_height;
  /// [tracers] the same height for each tracer; NaN if unknown.
  std::vector<double> tracer_rest_heights = {};
  /// Height of the resting bed's centre of mass above the plate, sigma: the value in the options, else that
  /// of the first frame at phase 0 if the bed rests on the plate in it (resting_height in
  /// centre_of_mass.hpp).
  std::optional<double> rest_height = {};
  std::string no_rest_height = {};  ///< why there is no rest height; empty if there is one
};

/// The neighbour rule of the analysis, in words.
std::string neighbour_rule_text(const AnalysisContext& context);

/// One frame with derived data that are computed at most once and shared by all observables.
class FrameView {
 public:
  FrameView(const Frame& frame, const AnalysisContext& context) : frame_(frame), context_(context) {}
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// Neighbours by the rule of the analysis.
  [[nodiscard]] const Neighbours& neighbours() const;
  /// Bond order from those neighbours.
  [[nodiscard]] const BondOrder& order() const;
  /// The Voronoi cells, independent of the rule.
  /// \pre the trajectory is planar
  [[nodiscard]] const VoronoiCells& cells() const;

 private:
  const Frame& frame_;
  const AnalysisContext& context_;
  mutable std::optional<Neighbours> neighbours_;
  mutable std::optional<BondOrder> order_;
  mutable std::optional<VoronoiCells> cells_;
};

/// An accumulator that receives each frame once, in order.
class Observable {
 public:
  virtual ~Observable() = default;
  /// Adds a frame. Frames come once each, in the order of the trajectory.
  virtual void add(const FrameView& view) = 0;
  /// The results of the frames added so far, present or absent, one for each name of its ObservableEntry that
  /// applies to the trajectory.
  [[nodiscard]] virtual std::vector<Result> results() const = 0;
};

/// How the values of several runs of one setting are combined (runs/pooling.hpp).
enum class Pooling {
  mean,
  probability,       ///< the mean; its interval is binomial if no run has an event
  root_mean_square,  ///< square root of the mean square: displacements
  sum,               ///< counts
  angle,             ///< circular mean with the period of a hexagonal lattice, 60 degrees
  per_bead,          ///< not pooled: an element belongs to a bead, and the beads of two runs differ
};

/// Values that a quantity can have by its definition. The intervals of its estimates are cut there, which
/// cannot cost coverage.
enum class Range {
  any,
  not_negative,
  share,  ///< [0, 1]
};
/// The result with its interval cut to the range that its name has. An estimate outside the range, such as
/// one from which noise was subtracted, keeps its interval.
Result cut_interval(Result result);
/// The interval of a result, before `cut_interval` cut it: the side that was cut is as long as the other one.
/// \pre the result has an interval
Interval uncut_interval(const Result& result);

/// A result that an observable gives.
struct NamedResult {
  std::string_view name;
  Pooling pooling = Pooling::mean;
  Range range = Range::any;
  /// Two different runs may well give the same value: a count, or a camera constant.
  bool may_repeat = false;
  bool main = false;  ///< one of the main results, which `analyze` and `measure` print without -v
  /// The result with the abscissas of a sparse profile, by which the elements of several runs are matched;
  /// empty for other results.
  std::string_view along = {};
  /// Value of a sparse profile at an abscissa that a run does not have: 0 for a filling or a stress, NaN,
  /// none, for a mean.
  double elsewhere = std::numeric_limits<double>::quiet_NaN();
  /// Number of the definition; raised by one whenever the definition changes, so that stored results of the
  /// earlier one are not mixed with new ones.
  int definition = 1;
  /// The share of beads of known size of a volume that is measured: as the power -dimension of lengths.
  bool filling = false;
  /// The power of the peak velocity of the drive over which it is: 2 of T_bar = T/(m V_p^2).
  int over_peak_velocity = 0;
  /// The error of a height above the plate, whose amplitude A is wrong by dA: this times dA. The plate is
  /// then off by dA sin(omega t), whose rms over a cycle is dA/sqrt(2).
  double above_plate = 0;
};

/// One observable: its results and its factory. NAME.cpp defines NAME_observable, the list in observables.cpp
/// names it.
struct ObservableEntry {
  std::span<const NamedResult> results;
  std::unique_ptr<Observable> (*make)(const AnalysisContext&);
  /// The members of AnalysisOptions on which its results depend, but for the cycles: "tracers" (or their
  /// band), "s_b", "neighbours" (and, by the rule, the cutoff or the radius of the cells), "cell_radius",
  /// "field_cell", "rest_height".
  std::array<std::string_view, 2> reads = {};
};
/// The factory of an observable that is constructed from the context.
template <class O>
std::unique_ptr<Observable> make_observable(const AnalysisContext& context) {
  return std::make_unique<O>(context);
}

/// The entry of the result of that name; without a known name, a result that is pooled by its mean.
NamedResult named_result(std::string_view name);

/// Refuses options that differ from their defaults and on which no requested result depends.
/// \throws ConfigError naming the option and the results that depend on it
void require_read(const AnalysisOptions& options);

/// Computes all results of a trajectory in one pass. Except for series with one value per cycle, memory does
/// not grow with the number of frames.
/// \throws ConfigError for an unknown name in `only`, a negative number of discarded or used cycles, a cutoff
/// that is not positive, or tracers that do not exist; InputError for a trajectory without frames
std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options = {},
                            Progress& progress = Progress::none());

/// Names of all results that `analyze` can return, in order.
std::vector<std::string> result_names();

/// The result called `name`.
/// \throws std::logic_error if there is none
const Result& find_result(const std::vector<Result>& results, const std::string& name);
/// The result called `name`, or null.
const Result* seek_result(const std::vector<Result>& results, const std::string& name);

}  // namespace twincell::analysis
