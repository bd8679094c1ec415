#pragma once
/// \file
/// Sweeps of the drive strength: the runs that Figs. 4 and 5 of Fortini & Huang 2015 share.

#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// Folder of the runs that Figs. 4 and 5 share.
inline constexpr const char* kStrengthSweepRuns = "p1-strength-sweep";

/// All runs at one drive strength.
struct SweepPoint {
  double gamma = 0;
  std::vector<Estimate> temperature;  ///< T_g* of each run, as a correlated series over cycles
  std::vector<double> p_s_of_runs;    ///< p_s of each run with eligible beads; empty in documents before it
  double slips = 0, eligible = 0;     ///< over all runs: slips, and bead-periods counted
  std::size_t runs = 0, bouncing = 0, convecting = 0;

  /// K_m = Gamma^2 at omega = 1.
  [[nodiscard]] double k_m() const { return gamma * gamma; }
  /// Mean over runs, with a bootstrap interval over runs from three runs on. A single run keeps its own
  /// interval. \pre there is a run
  [[nodiscard]] Estimate mean_temperature() const;
  /// Slip probability per bead and period, over all runs.
  [[nodiscard]] double p_s() const { return slips / eligible; }
  /// The same with its interval over runs, if there are several. Rows of beads slip together, so the number
  /// of slips alone does not give the error.
  [[nodiscard]] Estimate slip_probability() const;
  /// 95 % upper limit of p_s if no slip was counted, 3/eligible.
  [[nodiscard]] double upper_limit() const { return 3 / eligible; }
};

/// Results of one run.
struct SweepRun {
  double gamma = 0;
  Estimate temperature;
  double s_b = 0, s_c = 0;
  double slips = 0, eligible = 0;  ///< both 0 if no bead was eligible
};

/// Sweep of the drive strength from one start.
struct StrengthSweep {
  std::string start;               ///< "random" or "crystal_a"
  std::vector<SweepPoint> points;  ///< rising; only points with runs
  /// K_m at which s_c exceeds sigma (onset.hpp); region B is above. Absent if not found.
  std::optional<Estimate> convection;
  /// K_m of the first slips; region A1 is below. `low` is the last point before the weakest drive with slips,
  /// `high` that drive, and `value` their geometric mean. Absent if slips occur from the first bouncing point
  /// on, or at no point.
  std::optional<Estimate> first_slips;

  [[nodiscard]] bool is_random() const { return start == "random"; }
};

/// Points and regions from runs in any order.
StrengthSweep make_strength_sweep(const std::string& start, const std::vector<SweepRun>& runs);
/// Regions from points, which are rising in gamma.
StrengthSweep find_regions(const std::string& start, std::vector<SweepPoint> points);

/// Sweeps from both starts at one bed height.
struct HeightSweeps {
  int layers = 0;
  StrengthSweep random, crystal;
};

/// Sweeps at one or several bed heights: the paper does not state that of Figs. 4 and 5.
struct StrengthSweeps {
  std::vector<HeightSweeps> heights;  ///< rising, not empty; of several, only those with runs
  bool complete = false;
  std::string runs_text;  ///< seeds and cycles: "3 runs a point, 200 cycles"
  std::vector<std::string> conditions, cheaper;
};

/// Runs the sweeps, height by height, or reads the results that are in Request::runs or Request::stored.
/// Small budgets mean fewer points, cycles, seeds and heights. \param keys P1Run::keys \param share part of
/// the budget that these sweeps may use
StrengthSweeps strength_sweeps(const Request& request, const std::string& keys = {}, double share = 1);

/// Targets of Fig. 4 and of Fig. 5 at one height; the same ones in the same order for each height.
std::vector<Target> temperature_targets(const HeightSweeps& sweeps);
std::vector<Target> slip_targets(const HeightSweeps& sweeps);
/// Fig. 5: slip probability against 1/K_m, one row of panels for each height.
analysis::Figure slip_figure(const std::string& name, const StrengthSweeps& all);

/// Index of the height whose verdicts count. Both figures of the paper show one bed, so their targets are
/// compared with one height: the one that meets most of them (pass or consistent), then the one that fails
/// fewest, then the lowest.
std::size_t counted_height(const StrengthSweeps& sweeps);

/// The targets of a figure, each once: what was measured at each height with its verdict there, and the
/// verdict at counted_height().
std::vector<Target> targets_at_heights(const StrengthSweeps& sweeps,
                                       std::vector<Target> (*targets_at)(const HeightSweeps&));

/// Common output of the figures: K_m, T_g and slips of every point as text and as JSON, and the conditions.
Reproduction reproduction_of(const StrengthSweeps& sweeps, const std::string& title);

/// "random, N_l = 20": the title of a start at one height.
std::string title_of(const StrengthSweep& sweep, int layers);

/// Look of both figures: colour and gnuplot point type of a start, and gnuplot commands for the border of a
/// region at a value of the x axis; entries in the key for the starts and the borders.
const char* colour_of(const StrengthSweep& sweep);
int symbol_of(const StrengthSweep& sweep);
std::string border_of_region(double x);
std::string key_of_starts();
std::string key_of_border();

/// Least-squares fit of a law; empty if the fit fails, for example for too few points.
std::optional<calibration::CurveFit> fitted(const std::string& law,
                                            const std::vector<calibration::DataPoint>& points);
/// A parameter of a fit with its interval.
Estimate parameter(const calibration::CurveFit& fit, const std::string& name);

}  // namespace twincell::reproduce
