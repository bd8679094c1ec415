#pragma once
/// \file
/// Beds of one height along the strength of the drive: the runs that Figs. 4 and 5 of Fortini & Huang 2015
/// share.

#include <optional>
#include <string>
#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/estimate.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// Folder of the runs that Figs. 4 and 5 share.
inline constexpr const char* kLadderRuns = "p1-ladder";

/// All runs at one strength of the drive.
struct SweepPoint {
  double gamma = 0;
  std::vector<Estimate> temperature;  ///< T_g* of each run, by block averages over cycles
  double slips = 0, eligible = 0;     ///< counted over all runs; of how many bead-periods
  std::size_t runs = 0, bouncing = 0, convecting = 0;

  /// K_m = Gamma^2 at omega = 1.
  [[nodiscard]] double k_m() const { return gamma * gamma; }
  /// Mean over runs, its interval by bootstrap over them from three on; of one run its own. \pre there is a
  /// run
  [[nodiscard]] Estimate mean_temperature() const;
  [[nodiscard]] double p_s() const { return slips / eligible; }
  /// 95 % limit where no slip was counted, 3/eligible.
  [[nodiscard]] double upper_limit() const { return 3 / eligible; }
};

/// What one run said.
struct SweepRun {
  double gamma = 0;
  Estimate temperature;
  double s_b = 0, s_c = 0;
  double slips = 0, eligible = 0;  ///< 0, 0 where no bead was eligible
};

/// One start.
struct StrengthSweep {
  std::string start;               ///< "random" or "crystal_a"
  std::vector<SweepPoint> points;  ///< rising; those with runs alone
  /// K_m at which s_c passes sigma (onset.hpp), region B lies above. Absent if it was not found.
  std::optional<Estimate> convection;
  /// K_m between the strongest drive without any slip below the weakest with one, and that one: A1 lies
  /// below. Absent if there are slips from the first bouncing point on, or nowhere.
  std::optional<Estimate> first_slips;

  [[nodiscard]] bool is_random() const { return start == "random"; }
};

/// Rungs and regions from runs in any order.
StrengthSweep make_strength_sweep(const std::string& start, const std::vector<SweepRun>& runs);

struct StrengthSweeps {
  int layers = 0;
  bool complete = false;
  StrengthSweep random, crystal;
  std::vector<std::string> conditions, cheaper;
};

/// Runs the ladders, or takes up what is in Request::runs. Small budgets mean fewer points, cycles and seeds
/// and lower beds.
StrengthSweeps climb(const Request& request);

/// What every figure of the ladders says alike: K_m, T_g, p_s of every point for a reader and as JSON,
/// conditions.
Reproduction reproduction_of(const StrengthSweeps& ladders, const std::string& title);

/// The law fitted, all points alike; nothing where they are too few for it.
std::optional<CurveFit> fitted(const std::string& law, const std::vector<DataPoint>& points);
/// A parameter of a fit with its interval.
Estimate parameter(const CurveFit& fit, const std::string& name);

}  // namespace twincell::reproduce
