// Bhateja, Sharma & Singh 2016, Figs. 9 and 10: dependence of T_bar_z(W) and alpha on stiffness, restitution,
// friction and layers.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// One panel: a parameter of the rough 2D system and its values, the canonical one included.
struct Panel {
  std::string name, symbol, key;
  std::vector<double> values;
  std::vector<std::size_t> curves;  ///< one per value
};

/// Panels of Fig. 9. The paper does not state the system of Figs. 9 and 10.
std::vector<Panel> panels() {
  return {{"d", "N", "beads.layers", {2, 4, 6, 8}, {}},
          {"b", "e", "contact.restitution", {0.7, 0.8, 0.9, 0.95}, {}},
          {"c", "mu", "contact.mu", {0.1, 0.4, 0.8}, {}},
          {"a", "k_n", "contact.k_n", {1e5, 1e6, 1e7}, {}}};
}

const std::vector<int> kFrequencies = {500, 600, 700, 900, 1200, 1500, 2000, 3000, 4000};
constexpr double kSoftest = 1e5;
/// A parameter as a figure spells it: "μ = 0.4", "k_n = 10^{6}".
std::string symbol_text(const Panel& p) {
  return p.symbol == "mu" ? "μ" : p.symbol;
}
/// The parameter as the label of an axis.
std::string axis_text(const Panel& p) {
  return p.symbol == "e"    ? "coefficient of restitution e"
         : p.symbol == "mu" ? "friction coefficient μ"
                            : "number of layers N";
}
std::string legend_text(const Panel& p, double value) {
  return p.symbol == "k_n" ? fmt::format("k_n = 10^{{{:g}}}", std::log10(value))
                           : fmt::format("{} = {:g}", symbol_text(p), value);
}

/// The values of the other parameters: "e = 0.9, μ = 0.4, N = 4".
std::string held_text(const Panel& p) {
  std::vector<std::string> held;
  for (const auto& [symbol, text] :
       {std::pair{"e", "e = 0.9"}, std::pair{"mu", "μ = 0.4"}, std::pair{"N", "N = 4"}})
    if (p.symbol != symbol) held.emplace_back(text);
  return fmt::format("{}", fmt::join(held, ", "));
}

constexpr double kSoftUpTo = 23;  ///< W above which beads of k_n = 1e5 overlap by more than 5 %

/// Whether a value is canonical. Canonical values are left out of the scene, so that the other panels and
/// figures share the points.
bool canonical(const Panel& p, double value) {
  return (p.symbol == "N" && value == 4) || (p.symbol == "e" && value == 0.9) ||
         (p.symbol == "mu" && value == 0.4) || (p.symbol == "k_n" && value == 1e6);
}

void add_panel(Gas& gas, Panel& panel, const GasSize& size) {
  for (const double value : panel.values) {
    GasCurve curve{.name = fmt::format("{} = {:g}", panel.symbol, value),
                   .scene = "preset = \"bhateja-2016-rough-2d\"",
                   .relative_error = size.relative_error,
                   .cycles = size.cycles};
    if (!canonical(panel, value)) curve.scene += fmt::format("\n{} = {}", panel.key, value);
    for (const int rpm : kFrequencies)
      if (!(panel.symbol == "k_n" && value == kSoftest && w_of_rpm(rpm) > kSoftUpTo))
        curve.values.push_back(w_of_rpm(rpm));
    panel.curves.push_back(gas.add(curve));
  }
}

std::optional<Estimate> at_w(const Gas& gas, std::size_t curve, double w) {
  for (const GasPoint& p : gas.points(curve))
    if (std::abs(p.at / w - 1) < 0.01) return p.get("T_bar_z");
  return std::nullopt;
}

Target close_to_each_other(const Gas& gas, const Panel& p) {
  Target t{"(a) k_n = 1e5, 1e6, 1e7: T_bar_z", "the same within 5 %", "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  double most = 0;
  for (const double w : {w_of_rpm(900), w_of_rpm(1200), w_of_rpm(2000)})
    for (const std::size_t other : {std::size_t{0}, std::size_t{2}}) {
      const auto a = at_w(gas, p.curves[other], w), b = at_w(gas, p.curves[1], w);
      if (!a || !b) continue;
      const Estimate q = quotient(*a, *b);
      most = std::max(most, std::abs(q.value - 1));
      verdicts.push_back(judge(q, 0.95, 1.05));
    }
  if (verdicts.empty()) return t;
  t.measured = fmt::format("largest deviation from k_n = 1e6 {:.2g} % at W = 4.5, 8, 22", 100 * most);
  t.verdict = all_of(verdicts);
  return t;
}

/// Target that T_bar_z at W = 22 is monotonic in the parameter, with separate intervals for neighbouring
/// values.
Target monotonic(const Gas& gas, const Panel& p, bool rising, const std::string& name,
                 const std::string& expected) {
  Target t{name, expected, "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  std::optional<Estimate> last, first;
  for (std::size_t k = 0; k < p.values.size(); ++k) {
    const auto e = at_w(gas, p.curves[k], w_of_rpm(2000));
    if (!e) continue;
    t.measured +=
        fmt::format("{}{:g}: {}", t.measured.empty() ? p.symbol + " = " : ", ", p.values[k], e->text());
    if (last) verdicts.push_back(rising ? above(*e, *last) : above(*last, *e));
    last = e;
  }
  if (!verdicts.empty()) t.measured += " at W = 22.4";
  t.verdict = all_of(verdicts);
  return t;
}

/// Largest over smallest T_bar_z of a panel at W = 22.
std::optional<Estimate> reach(const Gas& gas, const Panel& p) {
  std::vector<Estimate> all;
  for (const std::size_t curve : p.curves) {
    const auto e = at_w(gas, curve, w_of_rpm(2000));
    if (!e) return std::nullopt;
    all.push_back(*e);
  }
  const auto [low, high] = std::minmax_element(
      all.begin(), all.end(), [](const Estimate& a, const Estimate& b) { return a.value < b.value; });
  return quotient(*high, *low);
}

Panel& panel_of(std::vector<Panel>& all, const std::string& symbol) {
  return *std::find_if(all.begin(), all.end(), [&](const Panel& p) { return p.symbol == symbol; });
}

struct Study {
  Gas gas;
  std::vector<Panel> all = panels();
  bool complete = false;
  Study(const Request& request, bool stiffness) : gas(request) {
    const GasSize& size = gas_size_for(request);
    if (!stiffness) all.pop_back();
    for (Panel& panel : all) add_panel(gas, panel, size);
    complete = gas.run();
  }
};

Reproduction begun(const Study& study, const std::string& title) {
  Reproduction r;
  r.title = title;
  r.complete = study.complete;
  r.measured = study.gas.as_json();
  r.conditions = study.gas.conditions();
  r.runs = study.gas.runs_text();
  r.cheaper = study.gas.cheaper();
  r.cheaper.push_back(
      fmt::format("{} frequencies, 2D rough (the paper does not say which system)", kFrequencies.size()));
  return r;
}

Reproduction run_9(const Request& request) {
  Study study(request, true);
  Gas& gas = study.gas;
  Reproduction r = begun(study, "Bhateja et al. 2016, Fig. 9: temperature with k_n, e, mu and N");
  r.targets = {close_to_each_other(gas, panel_of(study.all, "k_n")),
               monotonic(gas, panel_of(study.all, "e"), true, "(b) T_bar_z with e", "rises"),
               monotonic(gas, panel_of(study.all, "mu"), false, "(c) T_bar_z with mu", "falls slightly"),
               monotonic(gas, panel_of(study.all, "N"), false, "(d) T_bar_z with N", "falls")};
  Target order{"most impact: N; least: mu", "N above e above mu", "", Verdict::absent, ""};
  const auto n = reach(gas, panel_of(study.all, "N")), e = reach(gas, panel_of(study.all, "e")),
             mu = reach(gas, panel_of(study.all, "mu"));
  if (n && e && mu) {
    order.measured =
        fmt::format("largest over smallest at W = 22.4: N {}, e {}, mu {}", n->text(), e->text(), mu->text());
    // How far N and e are varied is not the same quantity, so their order cannot fail the target.
    order.verdict = all_of({above(*n, *mu), above(*e, *mu),
                            above(*n, *e) == Verdict::pass ? Verdict::pass : Verdict::inconclusive});
    if (order.verdict == Verdict::inconclusive)
      order.reason = "which of N and e is more depends on how far each is varied";
  }
  r.targets.push_back(order);
  for (const Panel& p : study.all) {
    std::vector<Series> series;
    for (std::size_t k = 0; k < p.values.size(); ++k)
      add_series(series, legend_text(p, p.values[k]), gas.points(p.curves[k]), "T_bar_z");
    r.figures.push_back(series_figure(
        {.name = "p2-fig9" + p.name,
         .panel = p.name.front(),
         .title = fmt::format("2D rough, {}", held_text(p)),
         .x = w_axis(),
         .y = {.label = "T_z/(m V_p^2)", .low = 0},
         .caption =
             fmt::format("2D rough, {} varied, with 95 % intervals. Form of Bhateja et al. 2016, Fig. 9({}).",
                         symbol_text(p), p.name)},
        series));
  }
  r.table = gas.table();
  return r;
}

/// alpha of T_z over [W_f, W_2].
std::optional<Estimate> alpha_of(const std::vector<GasPoint>& points, std::string& window) {
  const auto peak = peak_of(points);
  const auto w_2 = w_2_of(points);
  if (!peak || !w_2) return std::nullopt;
  std::vector<calibration::DataPoint> data;
  for (const GasPoint& p : points)
    if (const auto t = p.get("T_z"); t && p.at >= peak->grid && p.at <= *w_2 && !p.solid())
      data.push_back({.x = std::sqrt(p.at), .y = t->value});
  window = fmt::format("[{:.3g}, {:.3g}]", peak->grid, *w_2);
  if (data.size() < 3) return std::nullopt;
  const calibration::CurveFit fit = calibration::fit_curve(calibration::law_named("power"), data);
  Estimate e{.value = fit.fit.value("alpha"), .low = {}, .high = {}};
  if (fit.intervals[1]) {
    e.low = fit.intervals[1]->low;
    e.high = fit.intervals[1]->high;
  }
  return e;
}

Reproduction run_10(const Request& request) {
  Study study(request, false);
  Gas& gas = study.gas;
  Reproduction r = begun(study, "Bhateja et al. 2016, Fig. 10: alpha over [W_f, W_2] with e, mu and N");
  for (const Panel& p : study.all) {
    Series s{.title = "α over [W_f, W_2]", .x = {}, .y = {}};
    std::string said;
    for (std::size_t k = 0; k < p.values.size(); ++k) {
      std::string window = "no window";
      const auto alpha = alpha_of(gas.points(p.curves[k]), window);
      r.table += fmt::format("  {:<10} {} over {}\n", gas.curve(p.curves[k]).name,
                             alpha ? alpha->text() : "too few points", window);
      if (!alpha) continue;
      s.x.push_back(p.values[k]);
      s.y.push_back(*alpha);
      said += fmt::format("{}{:g}: {}", said.empty() ? p.symbol + " = " : ", ", p.values[k], alpha->text());
    }
    const bool enough = s.y.size() == p.values.size();
    if (p.symbol == "e") {
      Target t{"alpha with e", "rises gently", enough ? said : "", Verdict::absent, ""};
      if (enough) t.verdict = above(s.y.back(), s.y.front());
      r.targets.push_back(t);
    }
    if (p.symbol == "mu") {
      Target t{"alpha with mu", "marginal: changes by less than 0.2", enough ? said : "", Verdict::absent,
               ""};
      if (enough) {
        t.verdict = agree(s.y.back(), s.y.front(), 0.2);
      }
      r.targets.push_back(t);
    }
    if (p.symbol == "N") {
      Target t{"alpha with N", "falls", enough ? said : "", Verdict::absent, ""};
      Target deep{"alpha for N >= 6", "1.0 +- 0.2", "", Verdict::absent, ""};
      if (enough) {
        t.verdict = above(s.y.front(), s.y.back());
        std::vector<Verdict> verdicts;
        for (std::size_t k = 0; k < p.values.size(); ++k)
          if (p.values[k] >= 6) {
            verdicts.push_back(judge(s.y[k], 0.8, 1.2));
            deep.measured +=
                fmt::format("{}N = {:g}: {}", deep.measured.empty() ? "" : ", ", p.values[k], s.y[k].text());
          }
        deep.verdict = all_of(verdicts);
        deep.reason = "2D; where W_2 lies depends on the error of the last point";
      }
      r.targets.push_back(t);
      r.targets.push_back(deep);
    }
    SeriesFigure figure{
        .name = "p2-fig10-" + p.symbol,
        .panel = p.symbol == "e"    ? 'a'
                 : p.symbol == "mu" ? 'b'
                                    : 'c',
        .title = fmt::format("2D rough, {}", held_text(p)),
        .x = {.label = axis_text(p)},
        .y = {.label = "α"},
        .caption =
            "Exponent α of T_z with V_p over [W_f, W_2], 2D rough, with 95 % intervals. Form of "
            "Bhateja et al. 2016, Fig. 10."};
    // One range for the three panels, so that they can be compared.
    for (const double end : {0.7, 2.1}) figure.y.show(end);
    if (p.symbol == "N") {
      figure.marks =
          "set arrow from 6,1 to 8,1 nohead " + std::string(analysis::figure_style::kStated) + "\n";
      figure.entries = {analysis::figure_style::stated_line_entry("paper: about 1 for N ≥ 6")};
    }
    r.figures.push_back(series_figure(figure, {s}));
  }
  r.table += gas.table();
  return r;
}

}  // namespace

Reproducible p2_fig9() {
  Reproducible entry = gas_entry(
      "p2-fig9", "temperature against stiffness, restitution, friction and number of layers", run_9);
  entry.worth = 3;
  return entry;
}
Reproducible p2_fig10() {
  return gas_entry_of("p2-fig9", "p2-fig10",
                      "alpha over [W_f, W_2] against restitution, friction and number of layers", run_10);
}

}  // namespace twincell::reproduce
