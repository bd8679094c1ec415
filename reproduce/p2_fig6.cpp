// Bhateja, Sharma & Singh 2016, Fig. 6: without gravity alpha = 2, independent of amplitude and density.

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "calibration/fit/curve_fit.hpp"
#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// Without gravity d/V_p is the only time scale. With k_n ~ V_p^2, and therefore dt ~ 1/V_p, all numbers of
/// two runs differ by a power of two: alpha = 2 to the last bit. With constant k_n, collisions at high V_p
/// last longer relative to the flights.
struct Setting {
  std::string name;
  double amplitude, layers;
  std::vector<std::size_t> scaled, fixed;  ///< curves of one run each, one per V_p of kPeakVelocities
};

constexpr double kPeakVelocities[] = {1, 2, 4};
constexpr double kStiffness = 1e6;

std::size_t add_run(Gas& gas, const Setting& s, double v_p, double k_n, const GasSize& size) {
  return gas.add(
      {.name = fmt::format("{}, V_p = {:g}, k_n = {:g}", s.name, v_p, k_n),
       .scene = fmt::format("preset = \"bhateja-2016-zero-g\"\ndrive.amplitude = {}\ndrive.omega = {}\n"
                            "beads.layers = {}\ncontact.k_n = {}\nstart.velocity_scale = {}",
                            s.amplitude, v_p / s.amplitude, s.layers, k_n, v_p),
       .key = "start.seed",  // the same start for every V_p
       .values = {static_cast<double>(7)},
       .relative_error = std::min(size.relative_error, 0.03),
       .cycles = size.cycles,
       .discard = 50});
}

std::optional<calibration::CurveFit> slope_of(const Gas& gas, const std::vector<std::size_t>& curves) {
  std::vector<calibration::DataPoint> points;
  for (std::size_t k = 0; k < curves.size(); ++k)
    if (const auto t = gas.points(curves[k]).front().get("T_z"))
      points.push_back({.x = kPeakVelocities[k],
                        .y = t->value,
                        .sigma = t->low ? (*t->high - *t->low) / 4 : 0.02 * t->value});
  if (points.size() < std::size(kPeakVelocities)) return std::nullopt;
  return calibration::fit_curve(calibration::law_named("power"), points);
}

Target bitwise(const Gas& gas, const Setting& s) {
  Target t{s.name + ": T_z/V_p^2 at V_p = 1, 2, 4, k_n ~ V_p^2", "the same bits", "", Verdict::absent, ""};
  std::vector<double> values;
  for (const std::size_t k : s.scaled)
    if (const auto e = gas.points(k).front().get("T_bar_z")) values.push_back(e->value);
  if (values.size() < s.scaled.size()) return t;
  bool same = true;
  for (const double v : values)
    same = same && std::bit_cast<std::uint64_t>(v) == std::bit_cast<std::uint64_t>(values.front());
  const double alpha = 2 + std::log(values.back() / values.front()) / std::log(kPeakVelocities[2]);
  t.measured =
      fmt::format("{:.17g}, {:.17g}, {:.17g}: alpha = {:.15g}", values[0], values[1], values[2], alpha);
  t.verdict = holds(same);
  return t;
}

Target with_one_k_n(const Gas& gas, const Setting& s, std::vector<Estimate>& alphas) {
  Target t{s.name + ": alpha at one k_n = 1e6", "2.00 +- 0.02", "", Verdict::absent, ""};
  const auto fit = slope_of(gas, s.fixed);
  if (!fit) return t;
  Estimate e{.value = fit->fit.value("alpha"), .low = {}, .high = {}};
  if (const auto& interval = fit->intervals[1]) {
    e.low = interval->low;
    e.high = interval->high;
  }
  alphas.push_back(e);
  t.measured = e.text();
  t.verdict = judge(e, 1.98, 2.02);
  return t;
}

Reproduction run(const Request& request) {
  const GasSize& size = gas_size_for(request, 0.5);
  Gas gas(request);
  std::vector<Setting> settings = {{"A/d = 1, n = 4 layers", 1, 4, {}, {}}};
  // Stored runs have the settings of their own budget, whatever this one is.
  const double core_minutes =
      request.full || !request.stored.empty() ? 1e300 : request.minutes * request.threads;
  if (core_minutes >= 4)
    for (const double amplitude : {0.5, 2.0})
      settings.push_back({fmt::format("A/d = {:g}, n = 4 layers", amplitude), amplitude, 4, {}, {}});
  if (core_minutes >= 10)
    for (const double layers : {2.0, 6.0})
      settings.push_back({fmt::format("A/d = 1, n = {:g} layers", layers), 1, layers, {}, {}});
  if (!request.stored.empty())
    std::erase_if(settings,
                  [&](const Setting& s) { return request.stored.find(s.name) == std::string::npos; });
  for (Setting& s : settings)
    for (const double v_p : kPeakVelocities) {
      s.scaled.push_back(add_run(gas, s, v_p, kStiffness * v_p * v_p, size));
      s.fixed.push_back(v_p == 1 ? s.scaled.back() : add_run(gas, s, v_p, kStiffness, size));
    }
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 6: alpha without gravity, lid at 10 d";
  r.complete = gas.run();
  Series scaled{.title = "k_n ∝ V_p^2", .x = {}, .y = {}}, fixed{.title = "one k_n", .x = {}, .y = {}};
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const Setting& s = settings[k];
    r.targets.push_back(bitwise(gas, s));
    std::vector<Estimate> alphas;
    r.targets.push_back(with_one_k_n(gas, s, alphas));
    const auto number = static_cast<double>(k + 1);
    if (r.targets[2 * k].verdict == Verdict::pass) {
      scaled.x.push_back(number);
      scaled.y.push_back({.value = 2, .low = {}, .high = {}});
    }
    if (!alphas.empty()) {
      fixed.x.push_back(number + 0.1);
      fixed.y.push_back(alphas.front());
    }
    r.table += fmt::format("  setting {}: {}\n", k + 1, s.name);
  }
  r.table += gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  r.cheaper.push_back(fmt::format("{} settings of amplitude and density, V_p = 1, 2, 4", settings.size()));
  std::string ticks;
  for (std::size_t k = 0; k < settings.size(); ++k)
    ticks += fmt::format("{}\"A = {:g} d\\nn = {:g}\" {}", k == 0 ? "" : ", ", settings[k].amplitude,
                         settings[k].layers, k + 1);
  SeriesFigure figure{
      .name = "p2-fig6",
      .panel = 0,
      .title = "Exponent of T_z ∝ V_p^α without gravity, lid at 10 d",
      .x = {.label = "amplitude and number of layers"},
      .y = {.label = "α"},
      .caption =
          "Exponent of T_z with V_p, g = 0, lid 10 d above the floor, with 95 % intervals. With k_n ∝ V_p^2 "
          "the runs agree bit for bit, so α is exactly 2. Form of Bhateja et al. 2016, Fig. 6.",
      .marks = analysis::figure_style::stated_y(2) +
               fmt::format("set xlabel offset 0,-0.7\nset bmargin 7\nset xtics ({})\n", ticks),
      .entries = {analysis::figure_style::stated_line_entry("paper: α = 2")}};
  for (const double end : {0.6, static_cast<double>(settings.size()) + 0.4}) figure.x.show(end);
  for (const double end : {1.95, 2.05}) figure.y.show(end);
  r.figures = {series_figure(figure, {scaled, fixed})};
  return r;
}

}  // namespace

Reproducible p2_fig6() {
  return gas_entry("p2-fig6", "exponent alpha = 2 without gravity; bitwise scaling where k_n ~ V_p^2", run);
}

}  // namespace twincell::reproduce
