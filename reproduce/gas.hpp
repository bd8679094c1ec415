#pragma once
/// \file
/// Vibrated gases: the runs that the figures of Bhateja, Sharma & Singh 2016 share, and how they are drawn.

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/report/figures.hpp"
#include "reproduce/estimate.hpp"
#include "reproduce/reproduction.hpp"
#include "sweep/schedule.hpp"

namespace twincell::reproduce {

/// W = V_p^2/(d g) of the paper's frequency at A = d. The printed W fix d = 5 mm with g = 9.81 m/s^2.
double w_of_rpm(double rpm);
/// The paper's 300 to 4000 rpm in steps of 100.
std::vector<int> all_rpm();

/// One of the canonical systems of Fig. 2.
struct GasSystem {
  int dimension;
  bool rough;
  [[nodiscard]] std::string name() const;    ///< "2D rough"
  [[nodiscard]] std::string preset() const;  ///< "bhateja-2016-rough-2d"
};
/// The four of them, the rough one of the plane first.
const std::vector<GasSystem>& gas_systems();

/// What a budget buys: frequencies, the error asked of T_bar_z (half of the 95 % interval over the value) and
/// the cap of cycles. Never other physics.
struct GasSize {
  double core_minutes;  ///< from which on this size is chosen
  std::vector<int> rpm;
  double relative_error;
  int cycles;
};
/// The size for a request that needs `share` of what Fig. 2 needs.
const GasSize& gas_size_for(const Request& request, double share = 1);

/// a/b with the intervals' half-widths added as independent errors.
Estimate quotient(const Estimate& a, const Estimate& b);
/// One run of a gas.
struct GasPoint {
  double at = 0;  ///< value of the curve's key
  std::string id;
  bool done = false;
  std::string failed;  ///< what went wrong
  std::string until;   ///< how the run ended
  bool precise = false;
  std::int64_t cycles = 0;
  double contact_fraction = 0;
  std::map<std::string, Estimate> scalars;  ///< results of the analysis by name; absent ones are not here
  std::map<std::string, std::vector<double>> arrays;

  /// The result called `name`, if the run gave it.
  [[nodiscard]] std::optional<Estimate> get(const std::string& name) const;
  /// T_bar_z below kSolid: the bed rides on the plate.
  [[nodiscard]] bool solid() const;
};
/// Greatest T_bar_z of a bed that counts as solid.
inline constexpr double kSolid = 1e-4;

/// Runs that differ in one key of their scene.
struct GasCurve {
  std::string name;               ///< "2D rough", "e = 0.8"
  std::string scene;              ///< "preset = …" and keys, a line each
  std::string key = "drive.k_m";  ///< what is varied
  std::vector<double> values = {};
  double relative_error = 0.05;  ///< of `quantity`
  int cycles = 1000;             ///< at most
  int discard = 100;
  std::string quantity = "T_bar_z";
};

/// Curves and their runs, kept in a sweep's folder that all figures of the paper share: a point that one has
/// computed is there for the others.
class Gas {
 public:
  explicit Gas(const Request& request);
  /// Adds a curve; those added first are run first. \returns its number
  std::size_t add(const GasCurve& curve);
  /// A canonical system of Fig. 2 at these frequencies.
  std::size_t add(const GasSystem& system, const GasSize& size, const std::vector<int>& rpm);
  /// Computes what is open as far as the time goes, all curves equally far. \returns whether all is done
  bool run();
  [[nodiscard]] const GasCurve& curve(std::size_t k) const { return runs_[k].curve; }
  /// All points, in order of the key's values.
  [[nodiscard]] const std::vector<GasPoint>& points(std::size_t k) const { return runs_[k].points; }
  /// A line a point: W, T_bar_z in its conventions, the other results, correlation time, how the run ended.
  [[nodiscard]] std::string table() const;
  /// The same as JSON.
  [[nodiscard]] std::string as_json() const;
  /// What must be stated beside each number: contacts, step, start, cycles, seed, conventions.
  [[nodiscard]] std::vector<std::string> conditions() const;
  /// What the runs of this gas did more cheaply than the paper, and which of them the cap ended.
  [[nodiscard]] std::vector<std::string> cheaper() const;

 private:
  struct Runs {
    GasCurve curve;
    sweep::Plan plan;
    std::optional<sweep::Schedule> schedule;
    std::vector<GasPoint> points;
  };
  void read(Runs& runs) const;

  const Request& request_;
  sweep::Store store_;
  std::deque<Runs> runs_;  // schedules point to their plans: nothing may move
};

/// Points of a drawn curve.
struct Series {
  std::string title;
  std::vector<double> x;
  std::vector<Estimate> y;
  bool line = false;  ///< drawn as a line without points
  int dash = 1;
};
/// A result of a curve against its key, in units of `scale`(point) where given; points without it left out.
Series series_of(const std::string& title, const std::vector<GasPoint>& points, const std::string& result);
/// Points with error bars and lines in gnuplot's own colours. \param setup gnuplot commands before the plot
Figure series_figure(const std::string& name, const std::string& title, const std::string& x_label,
                     const std::string& y_label, const std::vector<Series>& all, const std::string& setup,
                     const std::string& caption);

/// W_f: where T_bar_z is largest, refined by the parabola in ln W through the largest point and its
/// neighbours. Empty for fewer than three fluid points.
struct Peak {
  double w = 0;         ///< refined
  double grid = 0;      ///< the point itself
  double height = 0;    ///< T_bar_z there
  bool inside = false;  ///< a point on either side is lower
};
std::optional<Peak> peak_of(const std::vector<GasPoint>& points);
/// The smallest x from which on a series stays within 5 % of its last value; empty for none.
/// \param errors_count  an interval that reaches there is enough
std::optional<double> flat_from(const Series& s, bool errors_count);
/// W_2: the smallest W beyond which T_bar_z stays within 5 % of its value at the largest W.
std::optional<double> w_2_of(const std::vector<GasPoint>& points);

/// Table III of the paper: T_bar_z(W) of the rough systems.
double table_3(int dimension, bool algebraic, double w);

}  // namespace twincell::reproduce
