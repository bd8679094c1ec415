// Bhateja, Sharma & Singh 2016, Fig. 2: T_bar_z against W in the four canonical systems.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/table.hpp"
#include "reproduce/gas.hpp"
#include "reproduce/user_points.hpp"

namespace twincell::reproduce {

namespace {

/// How a bed may begin. Just above W = 1, and where a bed can bounce as one block, the state depends on it.
struct Beginning {
  const char *name, *key;
};
constexpr Beginning kBeginnings[] = {{"abrupt", "drive.start = \"abrupt\""},
                                     {"moving along", "drive.start = \"comoving\""},
                                     {"boiling", "drive.schedule = [[0, 2], [20, 2], [30, 1]]"}};

/// W at which all beginnings are compared: 1.397, 1.703, 2.012 and 10.96.
std::vector<double> foot() {
  return {w_of_rpm(500), w_of_rpm(552), w_of_rpm(600), w_of_rpm(1400)};
}

/// Between two states a bed may creep, so that more cycles take hours and change little; 5 % tell states
/// apart.
constexpr int kMostCyclesOfFoot = 400;
constexpr double kErrorOfFoot = 0.05;

using Beginnings = std::array<std::size_t, std::size(kBeginnings)>;  ///< a curve for each of kBeginnings

struct Runs {
  std::vector<std::size_t> systems;  ///< curve of each of gas_systems()
  std::vector<Beginnings> feet;      ///< at foot(), for each of gas_systems()
};

Runs add_runs(Gas& gas, const GasSize& size) {
  Runs runs;
  for (const GasSystem& system : gas_systems()) runs.systems.push_back(gas.add(system, size, size.rpm));
  for (std::size_t k = 0; k < gas_systems().size(); ++k) {
    Beginnings& beginnings = runs.feet.emplace_back();
    for (std::size_t b = 0; b < beginnings.size(); ++b) {
      GasCurve curve = gas.curve(runs.systems[k]);
      curve.name = fmt::format("{}, begun {}", gas_systems()[k].name(), kBeginnings[b].name);
      curve.scene = fmt::format("preset = \"{}\"\n{}", gas_systems()[k].preset(), kBeginnings[b].key);
      curve.values = foot();
      curve.relative_error = std::max(curve.relative_error, kErrorOfFoot);
      curve.cycles = std::min(curve.cycles, kMostCyclesOfFoot);
      beginnings[b] = gas.add(curve);
    }
  }
  return runs;
}

const GasPoint* point_at(const std::vector<GasPoint>& points, double w) {
  for (const GasPoint& p : points)
    if (p.done && std::abs(p.at / w - 1) < 1e-9) return &p;
  return nullptr;
}

Target shape_of(const GasSystem& system, const std::vector<GasPoint>& points) {
  Target t{system.name() + ": shape", "zero, a rise, one maximum, a decay to a constant", "", Verdict::absent,
           ""};
  const auto peak = peak_of(points);
  if (!peak) return t;
  std::vector<Verdict> verdicts = {peak->inside ? Verdict::pass : Verdict::inconclusive};
  const GasPoint *solid = point_at(points, w_of_rpm(400)), *last = point_at(points, w_of_rpm(4000));
  if (solid != nullptr && solid->get("T_bar_z")) verdicts.push_back(holds(solid->solid()));
  const GasPoint* top = point_at(points, peak->grid);
  if (last != nullptr && top != nullptr)
    verdicts.push_back(above(*top->get("T_bar_z"), *last->get("T_bar_z")));
  t.measured =
      fmt::format("largest, {:.4g}, at W_f = {:.3g} (grid point {:.4g})", peak->height, peak->w, peak->grid);
  if (const auto w_2 = w_2_of(points)) {
    t.measured += fmt::format("; within 5 % of its last value from W_2 = {:.3g} on", *w_2);
    // Every series is near its last value at the end; a constant has to last.
    constexpr double kConstantFrom = 2.0 / 3;
    const bool lasts = *w_2 <= kConstantFrom * points.back().at;
    verdicts.push_back(lasts ? Verdict::pass : Verdict::inconclusive);
    if (!lasts) t.reason = "it still falls in the last third of W";
  }
  t.verdict = all_of(verdicts);
  return t;
}

/// Comparison of every point of a rough curve, from W_f to the end of the data, with Table III.
Target against_table_3(int dimension, const std::vector<GasPoint>& points) {
  constexpr double kTolerance = 0.10;
  Target t{fmt::format("{}D rough: Table III, algebraic, W_f < W <= 89.4", dimension), "each within 10 %", "",
           Verdict::absent, ""};
  const auto peak = peak_of(points);
  if (!peak) return t;
  std::vector<Verdict> verdicts;
  double low = 1e300, high = 0, sum = 0;
  std::string off;
  int solid = 0;
  for (const GasPoint& p : points) {
    const auto e = p.get("T_bar_z");
    if (!e || p.at < peak->grid) continue;
    if (p.solid()) {
      ++solid;
      continue;
    }
    const double curve = table_3(dimension, true, p.at), ratio = e->value / curve;
    verdicts.push_back(judge(*e, curve * (1 - kTolerance), curve * (1 + kTolerance)));
    low = std::min(low, ratio);
    high = std::max(high, ratio);
    sum += ratio;
    if (std::abs(ratio - 1) > kTolerance) off += fmt::format("{}{:.3g}", off.empty() ? "" : ", ", p.at);
  }
  if (verdicts.empty()) return t;
  t.measured = fmt::format("measured/Table III {:.3f} to {:.3f}, mean {:.3f} over {} points", low, high,
                           sum / static_cast<double>(verdicts.size()), verdicts.size());
  if (!off.empty()) t.measured += "; off by more at W = " + off;
  if (solid > 0) t.measured += fmt::format("; {} left out where the bed is solid", solid);
  t.verdict = all_of(verdicts);
  if (t.verdict == Verdict::fail && dimension == 2) t.reason = kExcessOfDiscs;
  return t;
}

/// Whether T_bar_z of one system is above that of another at each W at which both are a gas.
Target ordered(const std::string& name, const std::vector<GasPoint>& upper,
               const std::vector<GasPoint>& lower) {
  Target t{name, "at each W >= W_f", "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  double least = 1e300, most = 0;
  for (const GasPoint& p : lower) {
    const GasPoint* q = point_at(upper, p.at);
    if (q == nullptr || p.at < 2.7) continue;
    const auto a = q->get("T_bar_z"), b = p.get("T_bar_z");
    if (!a || !b || q->solid() || p.solid()) continue;
    verdicts.push_back(above(*a, *b));
    least = std::min(least, a->value / b->value);
    most = std::max(most, a->value / b->value);
  }
  if (verdicts.empty()) return t;
  t.measured = fmt::format("ratio {:.3g} to {:.3g} over {} points", least, most, verdicts.size());
  t.verdict = all_of(verdicts);
  return t;
}

std::vector<Target> targets_of(const Gas& gas, const Runs& runs) {
  const auto& rough_2d = gas.points(runs.systems[0]);
  const auto& rough_3d = gas.points(runs.systems[1]);
  const auto& smooth_2d = gas.points(runs.systems[2]);
  const auto& smooth_3d = gas.points(runs.systems[3]);
  std::vector<Target> targets;
  for (std::size_t k = 0; k < runs.systems.size(); ++k)
    targets.push_back(shape_of(gas_systems()[k], gas.points(runs.systems[k])));
  {
    Target t{"2D rough: W_f", "2 to 4.5", "", Verdict::absent, ""};
    if (const auto peak = peak_of(rough_2d)) {
      t.measured = fmt::format("{}, grid point {:.4g}; the interval reaches to its neighbours",
                               peak->position().text(), peak->grid);
      t.verdict = judge(peak->position(), 2, 4.5);
    }
    targets.push_back(t);
  }
  targets.push_back(against_table_3(2, rough_2d));
  targets.push_back(against_table_3(3, rough_3d));
  targets.push_back(ordered("2D: smooth above rough", smooth_2d, rough_2d));
  targets.push_back(ordered("3D: smooth above rough", smooth_3d, rough_3d));
  targets.push_back(ordered("rough: 2D above 3D", rough_2d, rough_3d));
  targets.push_back(ordered("smooth: 2D above 3D", smooth_2d, smooth_3d));
  {
    Target t{"2D smooth: solid at 300 and 400 rpm, not at 500", "T_bar_z < 1e-4, < 1e-4, > 1e-3", "",
             Verdict::absent, ""};
    const GasPoint *a = point_at(smooth_2d, w_of_rpm(300)), *b = point_at(smooth_2d, w_of_rpm(400)),
                   *c = point_at(smooth_2d, w_of_rpm(500));
    if (a != nullptr && b != nullptr && c != nullptr && a->get("T_bar_z") && b->get("T_bar_z") &&
        c->get("T_bar_z")) {
      const Estimate ta = *a->get("T_bar_z"), tb = *b->get("T_bar_z"), tc = *c->get("T_bar_z");
      t.measured = fmt::format("{:.2g}, {:.2g}, {}", ta.value, tb.value, tc.text());
      t.verdict = all_of({holds(a->solid()), holds(b->solid()), judge(tc, 1e-3, kUnbounded)});
    }
    targets.push_back(t);
  }
  {
    Target t{"largest mean volume fraction, at W_f, 2D", "0.2 +- 0.1", "", Verdict::absent,
             "the paper does not say up to which height; here the top of the highest bead"};
    std::vector<Verdict> verdicts;
    for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
      const auto peak = peak_of(gas.points(runs.systems[k]));
      const GasPoint* p = peak ? point_at(gas.points(runs.systems[k]), peak->grid) : nullptr;
      const auto phi = p != nullptr ? p->get("phi_top") : std::nullopt;
      if (!phi) continue;
      verdicts.push_back(judge(*phi, 0.1, 0.3));
      t.measured +=
          fmt::format("{}{} {}", t.measured.empty() ? "" : ", ", gas_systems()[k].name(), phi->text());
      if (const auto twice = p->get("phi_cm"))
        t.measured += fmt::format(" ({:.3g} up to twice the centre of mass)", twice->value);
    }
    t.verdict = all_of(verdicts);
    targets.push_back(t);
  }
  return targets;
}

/// "one state", or "depends on the beginning" where two values differ by more than their errors and a fifth.
std::string states_of(const std::vector<Estimate>& all) {
  constexpr double kApart = 1.2;
  if (all.size() < 2) return "";
  const auto [least, most] = std::minmax_element(
      all.begin(), all.end(), [](const Estimate& a, const Estimate& b) { return a.value < b.value; });
  if (most->value < kSolid) return "solid";
  const bool apart = most->value > kApart * least->value && above(*most, *least) == Verdict::pass;
  return apart ? "depends on the beginning" : "one state";
}

/// T_bar_z of each beginning at each W of the foot, and whether they lead to one state.
std::string table_of_beginnings(const Gas& gas, const Runs& runs) {
  std::string s =
      "  T_bar_z just above W = 1, and where the bed may bounce as one block, by the beginning of the run\n";
  for (std::size_t k = 0; k < runs.feet.size(); ++k) {
    s += fmt::format("  {:<10} {:>9}", gas_systems()[k].name(), "W");
    for (const Beginning& b : kBeginnings) s += fmt::format(" {:>28}", b.name);
    s += "\n";
    for (const GasPoint& first : gas.points(runs.feet[k][0])) {
      s += fmt::format("  {:<10} {:>9.4g}", "", first.at);
      std::vector<Estimate> all;
      for (const std::size_t curve : runs.feet[k]) {
        const GasPoint* p = point_at(gas.points(curve), first.at);
        const auto t = p != nullptr ? p->get("T_bar_z") : std::nullopt;
        s += fmt::format(" {:>28}", t ? t->text() : "-");
        if (t) all.push_back(*t);
      }
      s += fmt::format("  {}\n", states_of(all));
    }
  }
  return s;
}

/// The foot of one system: T_bar_z(W) by the beginning.
analysis::Figure foot_figure(const Gas& gas, const Runs& runs, std::size_t k) {
  constexpr double kAside = 0.015;
  std::vector<Series> all;
  for (std::size_t b = 0; b < std::size(kBeginnings); ++b) {
    Series series = series_of(kBeginnings[b].name, gas.points(runs.feet[k][b]), "T_bar_z");
    // Side by side, so that no symbol hides another.
    for (double& w : series.x) w *= 1 + kAside * (static_cast<double>(b) - 1);
    all.push_back(std::move(series));
  }
  const GasSystem& system = gas_systems()[k];
  SeriesFigure figure{
      .name = fmt::format("p2-fig2-foot-{}d-{}", system.dimension, system.rough ? "rough" : "smooth"),
      .panel = 0,
      .title = fmt::format("Foot of the curve, {}, by the beginning of the run", system.name()),
      .x = w_axis(),
      .y = {.label = "T_z/(m V_p^2)", .logarithmic = true},
      .caption = fmt::format(
          "Scaled temperature of the {} system at small W and at W = 10.96, of runs that begin abruptly from "
          "rest (as in the paper), moving along with the plate, or boiling; drawn side by side. Where "
          "heights "
          "differ, the bed has more than one state.",
          system.name()),
      .marks = "set xtics ('1.4' 1.4, '1.7' 1.7, '2' 2, '3' 3, '5' 5, '7' 7, '11' 11)\n"};
  return series_figure(figure, all);
}

/// The user's points, read before the runs, so that an invalid table is reported early.
std::optional<Series> own_of(const Request& request) {
  if (request.data.empty()) return std::nullopt;
  const Table table = read_table(request.data);
  Series s{.title = "yours", .x = own_column(table, "W"), .y = {}};
  for (const double t : own_column(table, "T_bar_z")) s.y.push_back({.value = t, .low = {}, .high = {}});
  return s;
}

analysis::Figure figure_of(const Gas& gas, const Runs& runs, const Request& request,
                           const std::optional<Series>& own) {
  std::vector<Series> all;
  for (std::size_t k = 0; k < runs.systems.size(); ++k)
    add_series(all, gas_systems()[k].name(), gas.points(runs.systems[k]), "T_bar_z");
  for (const int dimension : {2, 3}) {
    Series s{.title = fmt::format("Table III, {}D rough", dimension),
             .x = {},
             .y = {},
             .line = true,
             .dash = dimension};
    for (double w = 2.74; w <= 89.5; w *= 1.03) {
      s.x.push_back(w);
      s.y.push_back({.value = table_3(dimension, true, w), .low = {}, .high = {}});
    }
    all.push_back(s);
  }
  if (own) all.push_back(*own);
  SeriesFigure figure{
      .name = "p2-fig2",
      .panel = 0,
      .title = "Temperature of four systems, A = d, N = 4",
      .x = w_axis(),
      .y = {.label = "T_z/(m V_p^2)", .low = 0},
      .caption =
          "Scaled temperature, T_z = m <w'^2> about the instantaneous centre of mass, with 95 % intervals, "
          "and the algebraic curves of Table III. Open symbols: solid beds, T_z < 10⁻⁴ m V_p², which are "
          "left out of all fits. "
          "Bars at the top: windows of W of earlier experiments. Form of Bhateja et al. 2016, Fig. 2."};
  // The windows of earlier experiments lie above all points.
  constexpr double kHeightOfWindows = 1.14, kTopOfAxis = 1.28;
  figure.x.show(0.5);
  figure.x.show(135);
  figure.y.show(kTopOfAxis);
  const auto window = [&](const char* who, double low, double high, double at, const char* colour) {
    figure.marks += fmt::format(
        "set arrow from {0},{2} to {1},{2} heads size graph 0.01,90 lw 1.5 lc rgb '{3}'\n"
        "set label '{4}' at {5:.4g},{6} {7} tc rgb '{3}'\n",
        low, high, at, colour, who, high > 100 ? high : std::sqrt(low * high), at + 0.08,
        high > 100 ? "right" : "center");
  };
  window("Warr et al.", 0.5, 9, kHeightOfWindows, "#555555");
  window("Feitosa and Menon", 44, 135, kHeightOfWindows, "#555555");
  if (request.window) window("your window", request.window->first, request.window->second, -0.1, "#222222");
  return series_figure(figure, all);
}

Reproduction run(const Request& request) {
  const GasSize& size = gas_size_for(request);
  const std::optional<Series> own = own_of(request);
  Gas gas(request);
  const Runs runs = add_runs(gas, size);
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 2: scaled temperature against W in four systems";
  r.complete = gas.run();
  r.targets = targets_of(gas, runs);
  r.table = table_of_beginnings(gas, runs) + gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  if (size.rpm.size() < all_rpm().size())
    r.cheaper.push_back(fmt::format("{} of the 38 frequencies", size.rpm.size()));
  r.figures = {figure_of(gas, runs, request, own)};
  for (std::size_t k = 0; k < runs.feet.size(); ++k) r.figures.push_back(foot_figure(gas, runs, k));
  return r;
}

}  // namespace

Reproducible p2_fig2() {
  Reproducible entry = gas_entry(
      "p2-fig2", "scaled granular temperature against W in four systems, compared with Table III", run);
  entry.takes_data = true;
  entry.time_share = 5;
  return entry;
}

}  // namespace twincell::reproduce
