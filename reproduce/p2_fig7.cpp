// Bhateja, Sharma & Singh 2016, Fig. 7: T_bar_z divided by the scaled lift of the centre of mass, against W.

#include <fmt/format.h>

#include <cmath>

#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

Series ratio_of(const std::string& name, const std::vector<GasPoint>& points) {
  Series s{.title = name, .x = {}, .y = {}};
  for (const GasPoint& p : points) {
    const auto t = p.get("T_bar_z"), h = p.get("delta_h_bar");
    if (!t || !h || p.solid() || !(h->value > 0)) continue;
    s.x.push_back(p.at);
    s.y.push_back(quotient(*t, *h));
  }
  return s;
}

/// Value of the point nearest to `w` on a logarithmic axis; null if none is within |ln(W/w)| < 0.2.
const Estimate* near(const Series& s, double w) {
  const Estimate* best = nullptr;
  double distance = 0.2;
  for (std::size_t k = 0; k < s.x.size(); ++k)
    if (const double d = std::abs(std::log(s.x[k] / w)); d < distance) {
      distance = d;
      best = &s.y[k];
    }
  return best;
}

std::vector<Target> targets_of(const std::string& name, const Series& s) {
  constexpr double kPeak = 2.74, kMiddle = 20, kHigh = 56, kEnd = 89.4;
  std::vector<Target> targets;
  const Estimate *first = near(s, kPeak), *middle = near(s, kMiddle), *high = near(s, kHigh),
                 *last = near(s, kEnd);
  Target rises{name + ": T_bar_z/dh_bar is not constant for W < 20", "rises", "", Verdict::absent, ""};
  if (first != nullptr && middle != nullptr) {
    rises.measured = fmt::format("{} at W = 2.7, {} near 20", first->text(), middle->text());
    rises.verdict = above(*middle, *first);
  }
  Target constant{name + ": it becomes constant at high W", "same at W = 50 ... 89 within 10 %", "",
                  Verdict::absent, ""};
  if (high != nullptr && last != nullptr) {
    const Estimate q = quotient(*last, *high);
    constant.measured = fmt::format("{} over {}, quotient {}", last->text(), high->text(), q.text());
    constant.verdict = judge(q, 0.9, 1.1);
  }
  return {rises, constant};
}

Reproduction run(const Request& request) {
  const GasSize& size = gas_size_for(request);
  Gas gas(request);
  Reproduction r;
  std::vector<Series> all;
  for (const GasSystem& system : gas_systems())
    if (system.rough) gas.add(system, size, size.rpm);
  r.title = "Bhateja et al. 2016, Fig. 7: temperature over the lift of the centre of mass";
  r.complete = gas.run();
  for (std::size_t k = 0; k < 2; ++k) {
    all.push_back(ratio_of(gas.curve(k).name, gas.points(k)));
    for (const Target& t : targets_of(all.back().title, all.back())) r.targets.push_back(t);
  }
  r.table = gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  r.cheaper.emplace_back("the height at rest is that of each run's own bed, settled at A = 0");
  r.figures = {series_figure(
      {.name = "p2-fig7",
       .panel = 0,
       .title = "Temperature over lift of the centre of mass, N = 4",
       .x = w_axis(),
       .y = {.label = "T_z/(m g Δh_{cm})", .low = 0},
       .caption =
           "T_z = m <w'^2> over m g times the lift of the centre of mass above its height at rest, with 95 % "
           "intervals. Solid beds, whose lift is 0, have no point. Form of Bhateja et al. 2016, Fig. 7.",
       .marks = analysis::figure_style::stated_x(20),
       .entries = {analysis::figure_style::stated_line_entry("paper: not constant below")}},
      all)};
  return r;
}

}  // namespace

Reproducible p2_fig7() {
  return gas_entry_of("p2-fig2", "p2-fig7", "ratio of temperature to centre-of-mass lift against W", run);
}

}  // namespace twincell::reproduce
