// Bhateja, Sharma & Singh 2016, Figs. 9 and 10: dependence of T_bar_z(W) and alpha on stiffness, restitution,
// friction and layers.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/alternatives.hpp"
#include "reproduce/exponent_error.hpp"
#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// One panel: a parameter of a rough system and its values, the canonical one included.
struct Panel {
  std::string name, symbol, key;
  std::vector<double> values;
  std::vector<std::size_t> curves;  ///< one per value
};

/// Panels of Fig. 9.
std::vector<Panel> panels() {
  return {{"d", "N", "beads.layers", {2, 4, 6, 8}, {}},
          {"b", "e", "contact.restitution", {0.7, 0.8, 0.9, 0.95}, {}},
          {"c", "mu", "contact.mu", {0.1, 0.4, 0.8}, {}},
          {"a", "k_n", "contact.k_n", {1e5, 1e6, 1e7}, {}}};
}

const std::vector<int> kFrequencies = {500, 600, 700, 900, 1200, 1500, 2000, 3000, 4000};
constexpr double kSoftest = 1e5;
constexpr double kWork = 2;  ///< work of the runs relative to that of Fig. 2
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

/// The rough systems. The paper does not state which of them Figs. 9 and 10 show.
std::vector<GasSystem> systems() {
  std::vector<GasSystem> rough;
  for (const GasSystem& system : gas_systems())
    if (system.rough) rough.push_back(system);
  return rough;
}

void add_panel(Gas& gas, const GasSystem& system, Panel& panel, const GasSize& size) {
  for (const double value : panel.values) {
    GasCurve curve{.name = fmt::format("{}, {} = {:g}", system.name(), panel.symbol, value),
                   .scene = fmt::format("preset = \"{}\"", system.preset()),
                   .relative_error = size.relative_error,
                   .cycles = size.cycles};
    if (!canonical(panel, value)) curve.scene += fmt::format("\n{} = {}", panel.key, value);
    for (const int rpm : kFrequencies)
      if (!(panel.symbol == "k_n" && value == kSoftest && w_of_rpm(rpm) > kSoftUpTo))
        curve.values.push_back(w_of_rpm(rpm));
    panel.curves.push_back(gas.add(curve));
  }
}

/// Points that a target uses: whether the cap of cycles ended each before T_bar_z was as precise as asked.
/// Panels share their canonical points, which count once.
struct Used {
  std::map<std::string, bool> at_cap = {};  ///< by GasPoint::id

  void add(const GasPoint& p) { at_cap[p.id] = !p.precise; }
  void add(const Used& other) { at_cap.insert(other.at_cap.begin(), other.at_cap.end()); }
  /// "; 3 of 24 points at their cap"
  [[nodiscard]] std::string text() const {
    return fmt::format("; {} of {} points at their cap",
                       std::ranges::count_if(at_cap, [](const auto& p) { return p.second; }), at_cap.size());
  }
};

/// T_bar_z of the point at this W, which is entered into the points used.
std::optional<Estimate> at_w(const Gas& gas, std::size_t curve, double w, Used& used) {
  for (const GasPoint& p : gas.points(curve))
    if (std::abs(p.at / w - 1) < 0.01) {
      const auto t = p.get("T_bar_z");
      if (t) used.add(p);
      return t;
    }
  return std::nullopt;
}

Target close_to_each_other(const Gas& gas, const Panel& p) {
  Target t{"(a) k_n = 1e5, 1e6, 1e7: T_bar_z", "the same within 5 %", "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  double most = 0;
  Used used;
  for (const double w : {w_of_rpm(900), w_of_rpm(1200), w_of_rpm(2000)})
    for (const std::size_t other : {std::size_t{0}, std::size_t{2}}) {
      const auto a = at_w(gas, p.curves[other], w, used), b = at_w(gas, p.curves[1], w, used);
      if (!a || !b) continue;
      const Estimate q = quotient(*a, *b);
      most = std::max(most, std::abs(q.value - 1));
      verdicts.push_back(judge(q, 0.95, 1.05));
    }
  if (verdicts.empty()) return t;
  t.measured =
      fmt::format("largest deviation from k_n = 1e6 {:.2g} % at W = 4.5, 8, 22", 100 * most) + used.text();
  t.verdict = all_of(verdicts);
  return t;
}

/// Target that T_bar_z at W = 22 rises or falls with the parameter.
Target with_parameter(const Gas& gas, const Panel& p, bool rising, const std::string& name,
                      const std::string& expected) {
  Target t{name, expected, "", Verdict::absent, ""};
  std::vector<Estimate> all;
  Used used;
  for (std::size_t k = 0; k < p.values.size(); ++k) {
    const auto e = at_w(gas, p.curves[k], w_of_rpm(2000), used);
    if (!e) continue;
    t.measured +=
        fmt::format("{}{:g}: {}", t.measured.empty() ? p.symbol + " = " : ", ", p.values[k], e->text());
    all.push_back(*e);
  }
  if (all.size() > 1) t.measured += " at W = 22.4" + used.text();
  t.verdict = trend_of(all, rising).verdict;
  return t;
}

/// Largest over smallest T_bar_z of a panel at W = 22.
std::optional<Estimate> reach(const Gas& gas, const Panel& p, Used& used) {
  std::vector<Estimate> all;
  for (const std::size_t curve : p.curves) {
    const auto e = at_w(gas, curve, w_of_rpm(2000), used);
    if (!e) return std::nullopt;
    all.push_back(*e);
  }
  const auto [low, high] = std::minmax_element(
      all.begin(), all.end(), [](const Estimate& a, const Estimate& b) { return a.value < b.value; });
  return quotient(*high, *low);
}

/// The panels of one system.
struct SystemPanels {
  GasSystem system;
  std::vector<Panel> panels;

  [[nodiscard]] const Panel& of(const std::string& symbol) const {
    return *std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.symbol == symbol; });
  }
};

struct Study {
  Gas gas;
  std::vector<SystemPanels> all;
  bool complete = false;
  Study(const Request& request, bool stiffness) : gas(request) {
    const GasSize& size = gas_size_for(request, kWork);
    for (const GasSystem& system : systems()) {
      std::vector<Panel> of_system = panels();
      if (!stiffness) of_system.pop_back();
      for (Panel& panel : of_system) add_panel(gas, system, panel, size);
      all.push_back({system, std::move(of_system)});
    }
    complete = gas.run();
  }
};

Reproduction begun(const Study& study, const std::string& title, std::size_t counted) {
  Reproduction r;
  // The paper does not state the system of Figs. 9 and 10.
  r.title =
      fmt::format("{}; verdicts of the {} beds, which meet most of the targets of (b) to (d) and of Fig. 10",
                  title, study.all[counted].system.name());
  r.complete = study.complete;
  r.measured = study.gas.as_json();
  r.conditions = study.gas.conditions();
  r.runs = study.gas.runs_text();
  r.cheaper = study.gas.cheaper();
  r.cheaper.push_back(fmt::format("{} frequencies", kFrequencies.size()));
  return r;
}

/// Targets of Fig. 9(b) to (d).
std::vector<Target> parameter_targets(const Gas& gas, const SystemPanels& of) {
  std::vector<Target> targets = {
      with_parameter(gas, of.of("e"), true, "(b) T_bar_z with e", "rises"),
      with_parameter(gas, of.of("mu"), false, "(c) T_bar_z with mu", "falls slightly"),
      with_parameter(gas, of.of("N"), false, "(d) T_bar_z with N", "falls")};
  Target order{"most impact: N; least: mu", "N above e above mu", "", Verdict::absent, ""};
  Used used;
  const auto n = reach(gas, of.of("N"), used), e = reach(gas, of.of("e"), used),
             mu = reach(gas, of.of("mu"), used);
  if (n && e && mu) {
    order.measured = fmt::format("largest over smallest at W = 22.4: N {}, e {}, mu {}{}", n->text(),
                                 e->text(), mu->text(), used.text());
    // How far N and e are varied is not the same quantity, so their order cannot fail the target.
    order.verdict = all_of({above(*n, *mu), above(*e, *mu),
                            above(*n, *e) == Verdict::pass ? Verdict::pass : Verdict::inconclusive});
    if (order.verdict == Verdict::inconclusive)
      order.reason = "which of N and e is more depends on how far each is varied";
  }
  targets.push_back(order);
  return targets;
}

/// alpha of T_z over [W_f, W_2].
struct Exponent {
  std::optional<Estimate> alpha;     ///< absent for fewer than three points
  std::string window = "no window";  ///< "[2.74, 50.3], without 4.53, where the bed bounces as a block"
  bool ends_with_data = false;       ///< T_bar_z still falls between the last two points: W_2 is not reached
  Used used = {};                    ///< points of the window, and the last one, which decides W_2
};

/// W at which T_bar_z is less than half of that at both neighbouring W: the bed bounces as a block there, and
/// the point does not belong to the power law of the gas.
std::vector<double> block_bouncing(const std::vector<GasPoint>& points) {
  std::vector<std::pair<double, double>> t;
  for (const GasPoint& p : points)
    if (const auto e = p.get("T_bar_z"); e && !p.solid()) t.emplace_back(p.at, e->value);
  std::vector<double> at;
  for (std::size_t k = 1; k + 1 < t.size(); ++k)
    if (t[k].second < 0.5 * std::min(t[k - 1].second, t[k + 1].second)) at.push_back(t[k].first);
  return at;
}

Exponent exponent_of(const std::vector<GasPoint>& points) {
  Exponent x;
  const auto peak = peak_of(points);
  const auto w_2 = w_2_of(points);
  if (!peak || !w_2) return x;
  const std::vector<double> blocks = block_bouncing(points);
  x.window = fmt::format("[{:.3g}, {:.3g}]", peak->grid, *w_2);
  std::vector<double> v_p;
  std::vector<Estimate> t_z;
  const GasPoint* last = nullptr;
  for (const GasPoint& p : points) {
    const auto t = p.get("T_z");
    if (t) last = &p;
    if (!t || p.at < peak->grid || p.at > *w_2 || p.solid()) continue;
    if (std::ranges::find(blocks, p.at) != blocks.end())
      x.window += fmt::format(", without {:.3g}, where the bed bounces as a block", p.at);
    else
      v_p.push_back(std::sqrt(p.at)), t_z.push_back(*t), x.used.add(p);
  }
  x.ends_with_data = *w_2 == points.back().at;
  if (last != nullptr) x.used.add(*last);
  if (x.ends_with_data) x.window += ", where the data end: W_2 is not reached";
  if (v_p.size() < 3) return x;
  std::vector<calibration::DataPoint> data;
  for (std::size_t k = 0; k < v_p.size(); ++k) data.push_back({.x = v_p[k], .y = t_z[k].value});
  x.alpha = exponent_with_error(calibration::fit_curve(calibration::law_named("power"), data), v_p, t_z);
  return x;
}

/// alpha for each value of a panel, and its windows.
struct Exponents {
  std::vector<double> values;  ///< those with an alpha
  std::vector<Estimate> alpha;
  std::string text;                ///< "N = 2: 1.91 [1.87, 1.95], 4: ..."
  std::string table;               ///< one line per value, with its window
  bool whole = false;              ///< whether every value has an alpha
  std::vector<double> open = {};   ///< values whose window ends with the data instead of at W_2
  Used used = {};                  ///< points of all windows
  std::vector<Used> used_of = {};  ///< points of the window of each of `values`
};

Exponents exponents_of(const Gas& gas, const Panel& p) {
  Exponents x;
  for (std::size_t k = 0; k < p.values.size(); ++k) {
    const auto [alpha, window, ends_with_data, used] = exponent_of(gas.points(p.curves[k]));
    x.table += fmt::format("  {:<20} {} over {}{}\n", gas.curve(p.curves[k]).name,
                           alpha ? alpha->text() : "too few points", window, used.text());
    if (!alpha) continue;
    x.values.push_back(p.values[k]);
    x.alpha.push_back(*alpha);
    x.used_of.push_back(used);
    x.used.add(used);
    if (ends_with_data) x.open.push_back(p.values[k]);
    x.text += fmt::format("{}{:g}: {}", x.text.empty() ? p.symbol + " = " : ", ", p.values[k], alpha->text());
  }
  x.whole = x.alpha.size() == p.values.size();
  return x;
}

/// Leaves a verdict open whose exponents belong to windows without an upper end. \param open values of the
/// parameter with such windows
void weigh_open_windows(Target& t, const std::vector<double>& open) {
  if (open.empty()) return;
  if (t.verdict == Verdict::pass || t.verdict == Verdict::consistent) t.verdict = Verdict::inconclusive;
  t.reason = fmt::format("W_2 is not reached for {:g}: T_bar_z still falls at W = 89", fmt::join(open, ", "));
}

/// Targets of Fig. 10.
std::vector<Target> exponent_targets(const Gas& gas, const SystemPanels& of) {
  const Exponents e = exponents_of(gas, of.of("e")), mu = exponents_of(gas, of.of("mu")),
                  n = exponents_of(gas, of.of("N"));
  const auto target = [](const char* name, const char* expected, const Exponents& x, auto judged) {
    Target t{name, expected, "", Verdict::absent, ""};
    if (!x.whole) return t;
    t.measured = x.text + x.used.text();
    t.verdict = judged();
    weigh_open_windows(t, x.open);
    return t;
  };
  std::vector<Target> targets = {
      target("alpha with e", "rises gently", e, [&] { return trend_of(e.alpha, true).verdict; }),
      target("alpha with mu", "marginal: changes by less than 0.2", mu,
             [&] { return agree(mu.alpha.back(), mu.alpha.front(), 0.2); }),
      target("alpha with N", "falls", n, [&] { return trend_of(n.alpha, false).verdict; })};
  Target deep{"alpha for N >= 6", "1.0 +- 0.2", "", Verdict::absent, ""};
  if (n.whole) {
    std::vector<Verdict> verdicts;
    Used used;
    for (std::size_t k = 0; k < n.values.size(); ++k)
      if (n.values[k] >= 6) {
        used.add(n.used_of[k]);
        verdicts.push_back(judge(n.alpha[k], 0.8, 1.2));
        deep.measured +=
            fmt::format("{}N = {:g}: {}", deep.measured.empty() ? "" : ", ", n.values[k], n.alpha[k].text());
      }
    deep.measured += used.text();
    deep.verdict = all_of(verdicts);
    std::vector<double> open = n.open;
    std::erase_if(open, [](double layers) { return layers < 6; });
    weigh_open_windows(deep, open);
  }
  targets.push_back(deep);
  return targets;
}

std::vector<Alternative> by_system(
    const Study& study,
    const std::function<std::vector<Target>(const Gas&, const SystemPanels&)>& targets_of) {
  std::vector<Alternative> all;
  for (const SystemPanels& of : study.all) all.push_back({of.system.name(), targets_of(study.gas, of)});
  return all;
}

/// Index of the system whose verdicts count. It is the same for both figures, so Fig. 9(a), whose runs Fig.
/// 10 does not have, is left out.
std::size_t counted_system(const Study& study) {
  return meets_most(by_system(study, [](const Gas& gas, const SystemPanels& of) {
    std::vector<Target> both = parameter_targets(gas, of);
    for (Target& t : exponent_targets(gas, of)) both.push_back(std::move(t));
    return both;
  }));
}

/// The targets of one system, which states what the others measure. Each target names the system that decides
/// it, and the one whose verdict would be better.
std::vector<Target> decided_by(const std::vector<Alternative>& all, std::size_t counted) {
  std::vector<Target> targets = stating_all(all, counted);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    Target& t = targets[k];
    if (t.verdict == Verdict::absent) continue;
    t.reason += fmt::format("{}{} decides", t.reason.empty() ? "" : "; ", all[counted].name);
    for (const Alternative& other : all)
      if (const Verdict v = other.targets[k].verdict;
          v != Verdict::absent && v != t.verdict && best_of(v, t.verdict) == v)
        t.reason += fmt::format(", {} comes closer", other.name);
  }
  return targets;
}

Reproduction run_9(const Request& request) {
  const Study study(request, true);
  const Gas& gas = study.gas;
  const std::size_t counted = counted_system(study);
  Reproduction r = begun(study, "Bhateja et al. 2016, Fig. 9: temperature with k_n, e, mu and N", counted);
  r.targets = decided_by(by_system(study,
                                   [](const Gas& runs, const SystemPanels& of) {
                                     std::vector<Target> targets = {close_to_each_other(runs, of.of("k_n"))};
                                     for (Target& t : parameter_targets(runs, of))
                                       targets.push_back(std::move(t));
                                     return targets;
                                   }),
                         counted);
  for (const SystemPanels& of : study.all)
    for (const Panel& p : of.panels) {
      std::vector<Series> series;
      for (std::size_t k = 0; k < p.values.size(); ++k)
        add_series(series, legend_text(p, p.values[k]), gas.points(p.curves[k]), "T_bar_z");
      if (std::ranges::all_of(series, [](const Series& s) { return s.x.empty(); })) continue;  // not run
      r.figures.push_back(series_figure(
          {.name = fmt::format("p2-fig9{}-{}d", p.name, of.system.dimension),
           .panel = p.name.front(),
           .title = fmt::format("{}, {}", of.system.name(), held_text(p)),
           .x = w_axis(),
           .y = {.label = "T_z/(m V_p^2)", .low = 0},
           .caption =
               fmt::format("{}, {} varied, with 95 % intervals. Form of Bhateja et al. 2016, Fig. 9({}).",
                           of.system.name(), symbol_text(p), p.name)},
          series));
    }
  r.table = gas.table();
  return r;
}

Reproduction run_10(const Request& request) {
  const Study study(request, false);
  const Gas& gas = study.gas;
  const std::size_t counted = counted_system(study);
  Reproduction r =
      begun(study, "Bhateja et al. 2016, Fig. 10: alpha over [W_f, W_2] with e, mu and N", counted);
  r.targets = decided_by(by_system(study, exponent_targets), counted);
  for (const SystemPanels& of : study.all)
    for (const Panel& p : of.panels) r.table += exponents_of(gas, p).table;
  for (const Panel& p : study.all.front().panels) {
    SeriesFigure figure{
        .name = "p2-fig10-" + p.symbol,
        .panel = p.symbol == "e"    ? 'a'
                 : p.symbol == "mu" ? 'b'
                                    : 'c',
        .title = held_text(p),
        .x = {.label = axis_text(p)},
        .y = {.label = "α"},
        .caption =
            "Exponent α of T_z with V_p over [W_f, W_2] of the rough systems, with 95 % intervals. Form of "
            "Bhateja et al. 2016, Fig. 10."};
    // One range for the three panels, so that they can be compared.
    for (const double end : {0.7, 2.1}) figure.y.show(end);
    if (p.symbol == "N") {
      figure.marks =
          "set arrow from 6,1 to 8,1 nohead " + std::string(analysis::figure_style::kStated) + "\n";
      figure.entries = {analysis::figure_style::stated_line_entry("paper: about 1 for N ≥ 6")};
    }
    std::vector<Series> series;
    for (const SystemPanels& of : study.all) {
      const Exponents x = exponents_of(gas, of.of(p.symbol));
      if (!x.values.empty()) series.push_back({.title = of.system.name(), .x = x.values, .y = x.alpha});
    }
    r.figures.push_back(series_figure(figure, series));
  }
  r.table += gas.table();
  return r;
}

}  // namespace

Reproducible p2_fig9() {
  Reproducible entry = gas_entry(
      "p2-fig9", "temperature against stiffness, restitution, friction and number of layers", run_9);
  entry.time_share = 3;
  return entry;
}
Reproducible p2_fig10() {
  return gas_entry_of("p2-fig9", "p2-fig10",
                      "alpha over [W_f, W_2] against restitution, friction and number of layers", run_10);
}

}  // namespace twincell::reproduce
