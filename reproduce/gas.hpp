#pragma once
/// \file
/// Vibrated gases: the runs and plots that the figures of Bhateja, Sharma & Singh 2016 share.

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/report/figure_style.hpp"
#include "reproduce/reproduction.hpp"
#include "sweep/schedule.hpp"

namespace twincell::reproduce {

/// W = V_p^2/(d g) at the paper's frequency in rpm, with A = d. The printed W imply d = 5 mm with g = 9.81
/// m/s^2.
double w_of_rpm(double rpm);
/// The paper's frequencies, 300 to 4000 rpm in steps of 100.
std::vector<int> all_rpm();

/// The start of the drive as the paper has it: beads at rest, and a base that vibrates as A sin(omega t).
inline constexpr const char* kAbrupt = "drive.start = \"abrupt\"";

/// One of the canonical systems of Fig. 2.
struct GasSystem {
  int dimension;
  bool rough;
  [[nodiscard]] std::string name() const;    ///< "2D rough"
  [[nodiscard]] std::string preset() const;  ///< "bhateja-2016-rough-2d"
};
/// The four systems, beginning with the rough 2D system.
const std::vector<GasSystem>& gas_systems();

/// Extent of a study at a given budget: frequencies, required relative error of T_bar_z (half of the 95 %
/// interval over the value), and largest number of cycles. The physics does not depend on the budget.
struct GasSize {
  double core_minutes;  ///< smallest budget for this size, core-minutes
  std::vector<int> rpm;
  double relative_error;
  int cycles;
};
/// The size for a request whose work is `share` of that of Fig. 2.
const GasSize& gas_size_for(const Request& request, double share = 1);

/// An entry of the list whose runs are those of Gas.
Reproducible gas_entry(const std::string& name, const std::string& what,
                       const std::function<Reproduction(const Request&)>& run);
/// The same without runs of its own: `of` is the entry that computes them.
Reproducible gas_entry_of(const std::string& of, const std::string& name, const std::string& what,
                          const std::function<Reproduction(const Request&)>& run);

/// a/b, with the half-widths of the intervals combined as independent relative errors.
Estimate quotient(const Estimate& a, const Estimate& b);
/// One run of a gas.
struct GasPoint {
  double at = 0;  ///< value of the curve's key
  std::string id;
  bool done = false;
  std::string failed;  ///< error message of a failed run; else empty
  std::string until;   ///< how the run ended
  bool precise = false;
  std::int64_t cycles = 0;
  double contact_fraction = 0;
  std::map<std::string, Estimate> scalars;  ///< results of the analysis by name, without absent ones
  std::map<std::string, std::vector<double>> arrays;

  /// The result called `name`, if the run has it.
  [[nodiscard]] std::optional<Estimate> get(const std::string& name) const;
  /// Whether T_bar_z is below kSolid: the bed moves with the plate as a solid.
  [[nodiscard]] bool solid() const;
};
/// T_bar_z below which a bed counts as solid.
inline constexpr double kSolid = 1e-4;

/// Just above W = 1 a bed may creep between two states for thousands of cycles. At lower W than this, runs
/// end after kCyclesOfCreeping cycles at the latest.
inline constexpr double kCreeping = 1.9;
inline constexpr int kCyclesOfCreeping = 2000;

/// Runs that differ in one key of their scene.
struct GasCurve {
  std::string name;               ///< "2D rough", "e = 0.8"
  std::string scene;              ///< "preset = …" and keys, one per line
  std::string key = "drive.k_m";  ///< key that is varied
  std::vector<double> values = {};
  double relative_error = 0.05;  ///< required relative error of `quantity`
  int cycles = 1000;             ///< largest number of cycles; for W below kCreeping kCyclesOfCreeping
  int discard = 100;
  std::string quantity = "T_bar_z";
  std::string results = "";  ///< results of the analysis as a list of TOML; empty: those of all figures
};

/// Curves and their runs, stored in a sweep folder that all figures of the paper share, so that a point is
/// computed only once.
class Gas {
 public:
  /// Request::stored replaces the store: the points of a curve are those of its name in the document.
  explicit Gas(const Request& request);
  /// Adds a curve. \returns its index
  std::size_t add(const GasCurve& curve);
  /// Adds a canonical system of Fig. 2 at these frequencies. \returns its index
  std::size_t add(const GasSystem& system, const GasSize& size, const std::vector<int>& rpm);
  /// Computes the open points within the time limit, all curves at equal progress. \returns whether all
  /// points are done
  bool run();
  [[nodiscard]] const GasCurve& curve(std::size_t k) const { return runs_[k].curve; }
  /// All points, in order of the key's values.
  [[nodiscard]] const std::vector<GasPoint>& points(std::size_t k) const { return runs_[k].points; }
  /// Text table with one line per point: W, T_bar_z in its conventions, the other results, correlation time,
  /// and how the run ended.
  [[nodiscard]] std::string table() const;
  /// Seeds and cycles behind the points: "one run a point, 113 to 40000 cycles".
  [[nodiscard]] std::string runs_text() const;
  /// The same as JSON. \param with_profiles add the arrays over height
  [[nodiscard]] std::string as_json(bool with_profiles = false) const;
  /// Conditions to state with each number: contacts, step, start, cycles, seed, conventions.
  [[nodiscard]] std::vector<std::string> conditions() const;
  /// Simplifications relative to the paper, and the number of runs that the limit of cycles ended.
  [[nodiscard]] std::vector<std::string> cheaper() const;

 private:
  struct Runs {
    GasCurve curve;
    /// Of the values below kCreeping, and of the others.
    std::deque<sweep::Plan> plans;
    std::deque<sweep::Schedule> schedules;
    std::vector<GasPoint> points;
  };
  void read(Runs& runs) const;

  const Request& request_;
  sweep::Store store_;
  std::map<std::string, std::vector<GasPoint>> stored_;  ///< by curve
  std::deque<Runs> runs_;  // schedules refer to their plans, so that elements must not move
};

/// Points of a curve in a figure.
struct Series {
  std::string title;
  std::vector<double> x;
  std::vector<Estimate> y;
  bool line = false;  ///< drawn as a line without points
  int dash = 1;
  /// The series of points, counted from 0, whose colour and shape it has; absent: those of its own number.
  std::optional<std::size_t> of = {};
  bool solid = false;  ///< points of solid beds: the open shape of `of`
};
/// A result of the points against their key, without the points that lack it.
Series series_of(const std::string& title, const std::vector<GasPoint>& points, const std::string& result);
/// Adds a result of the points to the series of a figure: the beds that are a gas, and apart from them the
/// solid ones (GasPoint::solid), which the figure draws with open symbols. \param of_value what to draw of a
/// result at its key; empty: the result
void add_series(std::vector<Series>& all, const std::string& title, const std::vector<GasPoint>& points,
                const std::string& result,
                const std::function<Estimate(const Estimate&, double)>& of_value = {});

/// The axis W = V_p^2/(d g), logarithmic.
analysis::figure_style::PlotAxis w_axis();
/// A figure of series with error bars, and of lines. The ranges of its axes grow to hold the series.
struct SeriesFigure {
  std::string name;
  char panel;         ///< letter of the panel in the paper's figure; 0: none
  std::string title;  ///< what is drawn and of which system, as enhanced text
  analysis::figure_style::PlotAxis x, y;
  std::string caption;
  std::string marks = {};                 ///< gnuplot commands before the plot
  std::vector<std::string> entries = {};  ///< clauses after those of the series: marks in the key
};
analysis::Figure series_figure(SeriesFigure figure, const std::vector<Series>& all);

/// Maximum of T_bar_z(W), at W_f.
struct Peak {
  double w = 0;         ///< W_f, refined by the parabola in ln W through the largest point and its neighbours
  double grid = 0;      ///< W of the largest point
  double height = 0;    ///< T_bar_z of the largest point
  bool inside = false;  ///< whether there is a lower point on either side
  std::optional<double> left, right;  ///< W of the neighbouring points: the maximum lies between them

  /// W_f with the interval from the left to the right neighbour; open at an end of the points.
  [[nodiscard]] Estimate position() const { return {w, left, right}; }
};
/// Finds W_f. Empty for fewer than three points that are not solid.
std::optional<Peak> peak_of(const std::vector<GasPoint>& points);
/// Smallest x from which a series stays within 5 % of its last value, with the interval from the point before
/// to this point; empty for an empty series. \param errors_count accept points whose interval reaches into
/// this range
std::optional<Estimate> flat_from(const Series& s, bool errors_count);
/// W_2: smallest W from which T_bar_z stays within 5 % of its value at the largest W, errors counted.
std::optional<double> w_2_of(const std::vector<GasPoint>& points);

/// T_bar_z(W) of the rough systems by the printed fits of the paper's Table III.
double table_3(int dimension, bool algebraic, double w);

/// What decides the excess of rough discs over Table III: see p2_excess.cpp.
inline constexpr const char* kExcessOfDiscs =
    "an independent program of the same model lies 9 to 15 % above Table III at W = 35 to 89 too; of what "
    "the paper "
    "leaves open, c_t = 1.25 c_n and a resting ceiling at 100 d contradict none of the statements of "
    "`p2-excess`";

}  // namespace twincell::reproduce
