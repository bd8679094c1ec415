// Bhateja, Sharma & Singh 2016, Fig. 4: T_bar_x and T_bar against W.

#include <fmt/format.h>

#include <algorithm>

#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// T_x < T < T_z. T is between the two if T_x < T_z, so the intervals of these two must be separate. The
/// target also reports the ratio T_x/T_z.
/// \param rpm frequencies of the figure at this budget; solid beds among them have no order
Target order_of(const GasSystem& system, const std::vector<GasPoint>& points, const std::vector<int>& rpm) {
  Target t{system.name() + ": T_x < T < T_z", "for all W > 1", "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  double least = 1e300, most = 0;
  for (const GasPoint& p : points) {
    const auto x = p.get("T_x"), z = p.get("T_z");
    if (!x || !z || p.at < 1 || p.solid()) continue;
    const Estimate ratio = quotient(*x, *z);
    verdicts.push_back(above(*z, *x));
    least = std::min(least, ratio.value);
    most = std::max(most, ratio.value);
  }
  if (verdicts.empty()) return t;
  t.measured = fmt::format("T_x/T_z from {:.3g} to {:.3g} over {} points", least, most, verdicts.size());
  const auto solid =
      std::count_if(points.begin(), points.end(), [](const GasPoint& p) { return p.at > 1 && p.solid(); });
  const auto above_one = std::count_if(rpm.begin(), rpm.end(), [](int f) { return w_of_rpm(f) > 1; });
  t.verdict = all_of(verdicts, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, above_one - solid)));
  return t;
}

Target same_shape(const GasSystem& system, const std::vector<GasPoint>& points) {
  Target t{system.name() + ": T_bar like T_bar_z", "a maximum near W_f, then a decay", "", Verdict::absent,
           ""};
  const auto peak = peak_of(points);
  const GasPoint *top = nullptr, *last = nullptr;
  for (const GasPoint& p : points) {
    const auto e = p.get("T_bar");
    if (!e) continue;
    if (top == nullptr || e->value > top->get("T_bar")->value) top = &p;
    last = &p;
  }
  if (!peak || top == nullptr) return t;
  t.measured = fmt::format("T_bar largest at W = {:.3g}, T_bar_z at {:.3g}", top->at, peak->grid);
  // Neighbouring points of the paper's grid count as the same W.
  const bool near = std::max(top->at, peak->grid) / std::min(top->at, peak->grid) < 2.1;
  t.verdict = all_of({holds(near), above(*top->get("T_bar"), *last->get("T_bar"))});
  return t;
}

Reproduction run(const Request& request) {
  const GasSize& size = gas_size_for(request);
  Gas gas(request);
  for (const GasSystem& system : gas_systems()) gas.add(system, size, size.rpm);
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 4: horizontal and total temperature against W";
  r.complete = gas.run();
  std::vector<Series> horizontal, total;
  for (std::size_t k = 0; k < gas_systems().size(); ++k) {
    const GasSystem& system = gas_systems()[k];
    r.targets.push_back(order_of(system, gas.points(k), size.rpm));
    r.targets.push_back(same_shape(system, gas.points(k)));
    add_series(horizontal, system.name(), gas.points(k), "T_x",
               [](const Estimate& t, double w) { return quotient(t, {.value = w, .low = w, .high = w}); });
    add_series(total, system.name(), gas.points(k), "T_bar");
  }
  r.table = gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  const std::string form = " Open symbols: solid beds. Form of Bhateja et al. 2016, Fig. 4.";
  r.figures = {series_figure({.name = "p2-fig4a",
                              .panel = 'a',
                              .title = "horizontal temperature, A = d, N = 4",
                              .x = w_axis(),
                              .y = {.label = "T_x/(m V_p^2)", .low = 0},
                              .caption = "Horizontal temperature m <u'^2>." + form},
                             horizontal),
               series_figure({.name = "p2-fig4b",
                              .panel = 'b',
                              .title = "mean of the components, A = d, N = 4",
                              .x = w_axis(),
                              .y = {.label = "T/(m V_p^2)", .low = 0},
                              .caption = "Mean of the components of the temperature." + form},
                             total)};
  return r;
}

}  // namespace

Reproducible p2_fig4() {
  return gas_entry_of("p2-fig2", "p2-fig4", "horizontal and total temperature against W", run);
}

}  // namespace twincell::reproduce
