// Bhateja, Sharma & Singh 2016, Fig. 5: a horizontally shaken channel, with and without gravity.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// Extent of the study at a given budget: frequencies, and the period of the channel along y, to which the
/// number of beads is proportional.
struct Size {
  double core_minutes;
  std::vector<int> rpm;
  double depth;
  double relative_error;
  int cycles;
};

const Size& size_for(const Request& request) {
  static const std::vector<Size> all = {
      {0, {300, 600, 900}, 7, 0.1, 60},
      {10, {100, 200, 300, 450, 600, 900}, 7, 0.05, 200},
      {50, {100, 200, 300, 450, 600, 900}, 7, 0.05, 1000},
      {200, {40, 60, 80, 100, 150, 200, 300, 400, 500, 600, 700, 800, 900}, 7, 0.03, 2000},
      {1e300,
       {40, 60, 80, 100, 150, 200, 250, 300, 350, 400, 450, 500, 550, 600, 650, 700, 800, 900},
       35,
       0.01,
       2000}};
  if (request.full) return all.back();
  const Size* chosen = &all.front();
  for (const Size& size : all)
    if (request.minutes * request.threads >= size.core_minutes) chosen = &size;
  return *chosen;
}

constexpr double kAmplitude = 10, kBeadsPerDepth = 3000.0 / 35;

/// W of a point. The key is omega, which is also defined without gravity.
double w_of(const GasPoint& p) {
  return kAmplitude * kAmplitude * p.at * p.at;
}

/// W and T_z of the points of a curve.
using Curve = std::vector<std::pair<double, Estimate>>;

Curve curve_of(const std::vector<GasPoint>& points) {
  Curve all;
  for (const GasPoint& p : points)
    if (const auto t = p.get("T_bar_z")) all.emplace_back(w_of(p), *t);
  return all;
}

constexpr auto kLess = [](const auto& a, const auto& b) { return a.second.value < b.second.value; };

GasCurve runs_of(const Size& size, bool gravity) {
  GasCurve curve{.name = gravity ? "with gravity" : "without gravity",
                 .scene = fmt::format(
                     "preset = \"bhateja-2016-horizontal\"\ncell.depth = {}\nbeads.count = {}{}", size.depth,
                     std::lround(kBeadsPerDepth * size.depth), gravity ? "" : "\ncell.gravity = 0.0"),
                 .key = "drive.omega",
                 .relative_error = size.relative_error,
                 .cycles = size.cycles,
                 .discard = 30};
  for (const int rpm : size.rpm) curve.values.push_back(std::sqrt(w_of_rpm(rpm)));  // omega: V_p at A = d
  return curve;
}

Target constant_target(const Curve& without) {
  Target t{"without gravity: T_bar_z", "constant, variation at most 3 %", "", Verdict::absent, ""};
  if (without.size() >= 2) {
    const auto [low, high] = std::minmax_element(without.begin(), without.end(), kLess);
    const Estimate q = quotient(high->second, low->second);
    t.measured = fmt::format("largest over smallest {} over {} points", q.text(), without.size());
    t.verdict = judge(q, 1, 1.03);
  }
  return t;
}

Target peak_target(const Curve& with) {
  Target t{"with gravity: rises, then decays to a constant", "a maximum inside the range", "",
           Verdict::absent, ""};
  if (with.size() >= 3) {
    const auto top = std::max_element(with.begin(), with.end(), kLess);
    t.measured = fmt::format("largest {} at W = {:.3g}; {} at the last, W = {:.3g}", top->second.text(),
                             top->first, with.back().second.text(), with.back().first);
    const bool inside = top != with.begin() && top + 1 != with.end();
    t.verdict =
        inside ? all_of({above(top->second, with.front().second), above(top->second, with.back().second)})
               : Verdict::inconclusive;
    if (!inside) t.reason = "the largest lies at an end of the frequencies that were run";
  }
  return t;
}

Target second_peak_target(const Curve& with) {
  Target t{"with gravity: a second, smaller peak when beads strike the lid", "a second maximum", "",
           Verdict::absent, ""};
  if (with.size() >= 6) {
    const auto top = std::max_element(with.begin(), with.end(), kLess);
    auto dip = top;
    Verdict verdict = Verdict::inconclusive;
    for (auto p = top; p != with.end(); ++p) {
      if (p->second.value < dip->second.value) dip = p;
      if (above(p->second, dip->second) == Verdict::pass) verdict = Verdict::pass;
    }
    t.measured = fmt::format("lowest after the peak {} at W = {:.3g}", dip->second.text(), dip->first);
    t.verdict = verdict;
    if (verdict == Verdict::pass) {
      // With one run a point, a second maximum looks the same as a bed that is in its other state there.
      t.verdict = Verdict::inconclusive;
      t.reason = "one seed, and at W = 113 the bed has two states, which differ as much";
    }
  } else {
    t.reason = "too few frequencies at this budget";
  }
  return t;
}

analysis::Figure figure_of(const Curve& without, const Curve& with) {
  std::vector<Series> series;
  for (const bool gravity : {true, false}) {
    Series s{.title = gravity ? "with gravity" : "without gravity", .x = {}, .y = {}};
    for (const auto& [w, t] : gravity ? with : without) {
      s.x.push_back(w);
      s.y.push_back(t);
    }
    series.push_back(s);
  }
  return series_figure(
      {.name = "p2-fig5",
       .panel = 0,
       .title = "Channel shaken sideways, 3D smooth, e = 0.3, A = 10 d",
       .x = w_axis(),
       .y = {.label = "T_z/(m V_p^2)", .logarithmic = true},
       .caption =
           "Vertical temperature, drive along x, e = 0.3, smooth, with 95 % intervals; without gravity the "
           "abscissa is the same V_p. The paper: constant without gravity; with gravity a rise, a decay to a "
           "constant, and a second, smaller peak. Form of Bhateja et al. 2016, Fig. 5."},
      series);
}

Reproduction run(const Request& request) {
  const Size& size = size_for(request);
  Gas gas(request);
  for (const bool gravity : {false, true}) gas.add(runs_of(size, gravity));
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 5: vertical temperature in a channel shaken sideways";
  r.complete = gas.run();
  const Curve without = curve_of(gas.points(0)), with = curve_of(gas.points(1));
  // Constant without gravity; with gravity a maximum, and a second one when beads reach the lid.
  r.targets = {peak_target(with), second_peak_target(with), constant_target(without)};
  r.table = "  the key is omega; W = 100 omega^2\n" + gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  if (size.depth < 35)
    r.cheaper.push_back(fmt::format("period of {:g} d along y, {} beads, where the paper has 3000 (35 d)",
                                    size.depth, std::lround(kBeadsPerDepth * size.depth)));
  r.cheaper.push_back(fmt::format("{} frequencies", size.rpm.size()));
  r.figures = {figure_of(without, with)};
  return r;
}

}  // namespace

Reproducible p2_fig5() {
  Reproducible entry = gas_entry("p2-fig5", "a channel shaken sideways, with and without gravity", run);
  entry.time_share = 4;
  return entry;
}

}  // namespace twincell::reproduce
