// Bhateja, Sharma & Singh 2016, Fig. 8 and Table III: algebraic and exponential fits of T_bar_z(W), W >= W_f.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "calibration/fit/curve_fit.hpp"
#include "calibration/fit/fit_figure.hpp"
#include "core/json_text.hpp"
#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

struct Printed {
  double a, b, c, correlation;
};
Printed printed(int dimension, bool algebraic) {
  if (dimension == 2)
    return algebraic ? Printed{0.282, 0.656, 2.07, 0.9957} : Printed{0.327, 0.131, 1.022, 0.9941};
  return algebraic ? Printed{0.054, 0.622, 7.98, 0.9964} : Printed{0.092, 0.124, 2.695, 0.9943};
}

struct Fitted {
  int dimension = 2;
  bool algebraic = true;
  std::vector<calibration::DataPoint> points;
  std::optional<calibration::CurveFit> fit;
  [[nodiscard]] std::string name() const {
    return fmt::format("{}D rough, {}", dimension, algebraic ? "algebraic" : "exponential");
  }
};

Fitted fit_of(int dimension, bool algebraic, const std::vector<GasPoint>& points) {
  Fitted f{.dimension = dimension, .algebraic = algebraic, .points = {}, .fit = {}};
  const auto peak = peak_of(points);
  if (!peak) return f;
  for (const GasPoint& p : points)
    if (const auto t = p.get("T_bar_z"); t && p.at >= peak->grid && !p.solid())
      f.points.push_back({.x = p.at, .y = t->value});
  constexpr std::size_t kMinPoints = 5;  // three parameters and two degrees of freedom
  // Unweighted, as in plotting programs; the paper does not state its weights.
  if (f.points.size() >= kMinPoints)
    f.fit = calibration::fit_curve(calibration::law_named(algebraic ? "algebraic" : "exponential"), f.points);
  return f;
}

double value_of(const calibration::CurveFit& fit, const char* name) {
  return fit.fit.value(name);
}

void add_targets(std::vector<Target>& targets, const Fitted& f, bool coefficients) {
  const Printed p = printed(f.dimension, f.algebraic);
  Target curve{f.name() + ": the fitted curve against the printed one", "within 10 % on [W_f, 89.4]", "",
               Verdict::absent, ""};
  Target close{f.name() + ": correlation of points and curve", "at least 0.99", "", Verdict::absent, ""};
  Target signs{f.name() + ": signs of the residuals",
               f.algebraic ? "random, p > 0.05" : "systematic, p < 0.05", "", Verdict::absent, ""};
  if (f.fit) {
    constexpr double kErrors = 2;  // standard errors in half of a 95 % interval
    std::vector<Verdict> verdicts;
    double low = 1e300, high = 0, widest = 0;
    for (double w = f.points.front().x; w <= f.points.back().x; w *= 1.02) {
      const double printed_w = table_3(f.dimension, f.algebraic, w), ratio = f.fit->at(w) / printed_w;
      const double half = kErrors * f.fit->error_at(w) / printed_w;
      verdicts.push_back(judge({.value = ratio, .low = ratio - half, .high = ratio + half}, 0.9, 1.1));
      low = std::min(low, ratio);
      high = std::max(high, ratio);
      widest = std::max(widest, half);
    }
    curve.measured =
        fmt::format("fitted/printed from {:.3f} to {:.3f}, +- {:.3f} at most", low, high, widest);
    curve.verdict = all_of(verdicts);
    if (curve.verdict == Verdict::fail && f.dimension == 2) curve.reason = kExcessOfDiscs;
    close.measured = fmt::format("{:.4f}, printed {:.4f}", f.fit->correlation, p.correlation);
    close.verdict = holds(f.fit->correlation >= 0.99);
    signs.measured = fmt::format("{} runs of {} + and {} -, p = {:.3g}", f.fit->runs.runs,
                                 f.fit->runs.positive, f.fit->runs.negative, f.fit->runs.p);
    const bool random = !(f.fit->runs.p < 0.05);
    // Only systematic residuals can be shown: their absence at p > 0.05 is no proof that there are none.
    signs.verdict = random == f.algebraic ? (f.algebraic ? Verdict::consistent : Verdict::pass)
                    : f.algebraic         ? Verdict::fail
                                          : Verdict::inconclusive;
    if (signs.verdict == Verdict::inconclusive) signs.reason = "so few or so noisy points do not show it";
  }
  if (f.algebraic)
    curve.not_counted = "the points are those of `p2-fig2`";  // which compares the points with the same curve
  // Table III has the coefficients of the fits that Fig. 8 shows; each fit is judged once.
  if (!coefficients) {
    targets.insert(targets.end(), {curve, close, signs});
    return;
  }
  const auto coefficient = [&](std::size_t k, const char* name, double expected, double tolerance) {
    Target t{fmt::format("{}: {}", f.name(), name), fmt::format("{:g} +- {:.3g}", expected, tolerance), "",
             Verdict::absent, "coefficients are strongly correlated: compare curves"};
    if (f.fit) {
      Estimate e{.value = value_of(*f.fit, name), .low = {}, .high = {}};
      if (const auto& interval = f.fit->intervals[k]) {
        e.low = interval->low;
        e.high = interval->high;
      }
      t.measured = e.text();
      t.verdict = judge(e, expected - tolerance, expected + tolerance);
    }
    targets.push_back(t);
  };
  coefficient(0, "a", p.a, 0.25 * p.a);
  for (std::size_t k = 0; f.fit && k < f.fit->fit.names.size(); ++k)
    // 30 % of the algebraic b is 0.2; 0.2 for the exponential one, 0.131, would include 0.
    if (f.fit->fit.names[k] == "b") coefficient(k, "b", p.b, 0.3 * p.b);
}

std::string line_of(const Fitted& f) {
  if (!f.fit) return fmt::format("  {:<24} too few points\n", f.name());
  const Printed p = printed(f.dimension, f.algebraic);
  std::string s = fmt::format(
      "  {:<24} a {:.4g} ({:g})  b {:.4g} ({:g})  c {:.4g} ({:g})  correlation {:.4f} ({:.4f})  runs p "
      "{:.3g}  {} points\n",
      f.name(), value_of(*f.fit, "a"), p.a, value_of(*f.fit, "b"), p.b, value_of(*f.fit, "c"), p.c,
      f.fit->correlation, p.correlation, f.fit->runs.p, f.fit->n_used);
  for (const std::string& note : f.fit->notes) s += "    " + note + "\n";
  return s;
}

Reproduction run(const Request& request, bool coefficients) {
  const GasSize& size = gas_size_for(request);
  Gas gas(request);
  for (const GasSystem& system : gas_systems())
    if (system.rough) gas.add(system, size, size.rpm);
  Reproduction r;
  r.title = fmt::format("Bhateja et al. 2016, {}: fits of T_bar_z(W) from W_f on",
                        coefficients ? "Table III" : "Fig. 8");
  r.complete = gas.run();
  std::vector<Series> all;
  nlohmann::json fits = nlohmann::json::array();
  r.table = "  Measured (printed)\n";
  for (std::size_t k = 0; k < 2; ++k) {
    const int dimension = gas_systems()[k].dimension;
    Series fluid{.title = gas.curve(k).name, .x = {}, .y = {}};
    for (const GasPoint& p : gas.points(k))
      if (const auto t = p.get("T_bar_z"); t && !p.solid()) {
        fluid.x.push_back(p.at);
        fluid.y.push_back(*t);
      }
    all.push_back(fluid);
    for (const bool algebraic : {true, false}) {
      const Fitted f = fit_of(dimension, algebraic, gas.points(k));
      add_targets(r.targets, f, coefficients);
      r.table += line_of(f);
      if (!f.fit) continue;
      Series s{.title = f.name(), .x = {}, .y = {}, .line = true, .dash = algebraic ? 1 : 2, .of = k};
      for (double w = f.points.front().x; w <= f.points.back().x; w *= 1.03) {
        s.x.push_back(w);
        s.y.push_back({.value = f.fit->at(w), .low = {}, .high = {}});
      }
      all.push_back(s);
      analysis::Figure residuals = calibration::fit_figure(
          *f.fit, f.points, "W", "T̄_z",
          fmt::format("p2-fig8-{}d-{}", dimension, algebraic ? "algebraic" : "exponential"),
          fmt::format("{}: {}", f.name(), f.fit->law->formula));
      r.figures.push_back(residuals);
      fits.push_back(
          {{"system", gas.curve(k).name},
           {"law", algebraic ? "algebraic" : "exponential"},
           {"a", value_of(*f.fit, "a")},
           {"b", value_of(*f.fit, "b")},
           {"c", value_of(*f.fit, "c")},
           {"correlation", f.fit->correlation},
           {"runs_p", std::isfinite(f.fit->runs.p) ? nlohmann::json(f.fit->runs.p) : nlohmann::json()},
           {"points", f.fit->n_used}});
    }
  }
  r.table += gas.table();
  r.measured = json_text({{"fits", fits}, {"points", nlohmann::json::parse(gas.as_json())}});
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  r.figures.insert(
      r.figures.begin(),
      series_figure(
          {.name = "p2-fig8",
           .panel = 0,
           .title = "Algebraic and exponential fits from W_f on, A = d, N = 4",
           .x = w_axis(),
           .y = {.label = "T_z/(m V_p^2)", .logarithmic = true},
           .caption = "Algebraic and exponential fits from W_f on, with the points and their 95 % intervals. "
                      "Form of Bhateja et al. 2016, Fig. 8(b); residuals in the figures beside it."},
          all));
  return r;
}

}  // namespace

Reproducible p2_fig8() {
  return gas_entry_of("p2-fig2", "p2-fig8", "algebraic and exponential fits of T_bar_z(W), with residuals",
                      [](const Request& request) { return run(request, false); });
}

Reproducible p2_table3() {
  return gas_entry_of("p2-fig2", "p2-table3", "coefficients of the fits of p2-fig8",
                      [](const Request& request) { return run(request, true); });
}

}  // namespace twincell::reproduce
