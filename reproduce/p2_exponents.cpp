// Bhateja, Sharma & Singh 2016, Tables I and II: exponents of T_z and of the lift of the centre of mass with
// V_p, over the windows of W of earlier experiments or over the user's own window.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "calibration/fit/curve_fit.hpp"
#include "calibration/fit/fit_figure.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/table.hpp"
#include "reproduce/exponent_error.hpp"
#include "reproduce/gas.hpp"
#include "reproduce/user_points.hpp"

namespace twincell::reproduce {

namespace {

/// Marks a window that starts at W_f on the paper's grid (700 rpm for the rough 2D system), as Warr's fit of
/// T_z does.
constexpr double kFromPeak = -1;
constexpr const char* kWarr = "Warr et al.";
/// W below the maximum at which the bed is a gas; the lift is fitted from here.
constexpr double kLowOfWarr = 2;

/// An earlier experiment with its window and the paper's exponent.
struct Study {
  const char* name;
  int dimension;
  double low, high;  ///< W; NaN: only drawn in Fig. 2; kFromPeak: from W_f on
  double expected;   ///< exponent that the paper finds over that window
};

constexpr double kDrawn = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndOfData = 89.5;

const std::vector<Study>& studies(bool of_height) {
  static const std::vector<Study> temperature = {{kWarr, 2, kFromPeak, 9, 1.49},
                                                 {"Feitosa and Menon", 2, 44, 135, 1.92},
                                                 {"Wildman et al.", 3, kDrawn, kDrawn, 1.43},
                                                 {"Yang and Candela", 3, kDrawn, kDrawn, 1.12},
                                                 {"Windows-Yule and Parker", 3, kDrawn, kDrawn, 1.29}};
  static const std::vector<Study> height = {{kWarr, 2, kLowOfWarr, 9, 1.41},
                                            {"Wildman et al.", 3, kDrawn, kDrawn, 1.19},
                                            {"Yang and Candela", 3, kDrawn, kDrawn, 0.88},
                                            {"Windows-Yule and Parker", 3, kDrawn, kDrawn, 1.06}};
  return of_height ? height : temperature;
}

/// Whether a point is fluid and its W = V_p^2 lies in a window.
bool in_window(const calibration::DataPoint& p, double low, double high) {
  const double w = p.x * p.x;
  return w >= low && w <= high && p.y > 0;
}

/// Unweighted fit of ln y = ln C + alpha ln V_p over a window of W. Solid points have y = 0, so they are left
/// out and counted.
struct Exponent {
  std::string name;
  double low = 0, high = 0;
  std::vector<calibration::DataPoint> points;  ///< V_p, y; y = 0 for a solid bed
  std::optional<calibration::CurveFit> fit;
  std::string why_not;
  std::optional<double> printed = {};   ///< the paper's exponent over this window
  std::vector<Estimate> measured = {};  ///< y of the points with its interval; empty for the user's points

  [[nodiscard]] Estimate alpha() const {
    std::vector<double> x;
    std::vector<Estimate> y;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!in_window(points[k], low, high)) continue;
      x.push_back(points[k].x);
      y.push_back(measured.empty() ? Estimate{.value = points[k].y, .low = {}, .high = {}} : measured[k]);
    }
    return exponent_with_error(*fit, x, y);
  }
  [[nodiscard]] std::string text() const {
    std::string s =
        fmt::format("{} from {} points, W {:.3g} to {:.3g}", alpha().text(), fit->n_used, low, high);
    if (fit->n_zero > 0) s += fmt::format(", {} solid left out", fit->n_zero);
    return s;
  }
};

Exponent exponent_of(std::string name, std::vector<calibration::DataPoint> points, double low, double high) {
  Exponent e{.name = std::move(name),
             .low = low,
             .high = high,
             .points = std::move(points),
             .fit = {},
             .why_not = {}};
  const auto inside = std::ranges::count_if(
      e.points, [&](const calibration::DataPoint& p) { return in_window(p, low, high); });
  constexpr std::ptrdiff_t kMinFluidPoints = 3;
  if (inside < kMinFluidPoints)
    e.why_not = fmt::format("{} fluid points lie within W = {:.3g} to {:.3g}, {} are needed", inside, low,
                            high, kMinFluidPoints);
  else
    e.fit = calibration::fit_curve(calibration::law_named("power"), e.points,
                                   {.low = std::sqrt(low), .high = std::sqrt(high)});
  return e;
}

std::vector<calibration::DataPoint> of_gas(const std::vector<GasPoint>& points, bool of_height) {
  std::vector<calibration::DataPoint> all;
  for (const GasPoint& p : points)
    if (const auto y = p.get(of_height ? "delta_h_cm" : "T_z"))
      all.push_back({.x = std::sqrt(p.at), .y = p.solid() ? 0 : y->value});
  return all;
}

/// The same values with their intervals.
std::vector<Estimate> measured_of(const std::vector<GasPoint>& points, bool of_height) {
  std::vector<Estimate> all;
  for (const GasPoint& p : points)
    if (const auto y = p.get(of_height ? "delta_h_cm" : "T_z")) all.push_back(*y);
  return all;
}

/// Points from the user's columns W and T_bar_z (or delta_h_bar): y is the second column times V_p^2 = W.
std::vector<calibration::DataPoint> of_user(const std::filesystem::path& path, bool of_height) {
  const Table table = read_table(path);
  const auto &w = own_column(table, "W"),
             &y = own_column(table, of_height ? "delta_h_bar" : "T_bar_z", {.zero = true});
  std::vector<calibration::DataPoint> all;
  for (std::size_t k = 0; k < w.size(); ++k) all.push_back({.x = std::sqrt(w[k]), .y = y[k] * w[k]});
  return all;
}

std::string symbol(bool of_height) {
  return of_height ? "alpha_h" : "alpha";
}

/// \param other the same exponent over another window that the paper's text allows, or null
Target target_of(const Study& study, const Exponent* e, bool of_height, const Exponent* other = nullptr) {
  constexpr double kTolerance = 0.10;
  Target t{fmt::format("{}, {}D rough: {}", study.name, study.dimension, symbol(of_height)),
           fmt::format("{:g} +- {:g}", study.expected, kTolerance), "", Verdict::absent, ""};
  if (std::isnan(study.high)) {
    t.reason = "its window is only drawn in Fig. 2; --window LOW,HIGH tries one";
    return t;
  }
  if (e == nullptr) return t;
  if (!e->fit) {
    t.reason = e->why_not;
    return t;
  }
  t.measured = e->text();
  t.verdict = judge(e->alpha(), study.expected - kTolerance, study.expected + kTolerance);
  if (other != nullptr && other->fit)
    t.reason = fmt::format(
        "the paper states W 0.5 to 9, where beds below W = 2 are solid or creep; over W {:.3g} to {:g} "
        "it is {}",
        other->low, other->high, other->alpha().text());
  if (study.high > kEndOfData)
    t.reason = fmt::format("the paper's data end at W = 89.4, the window at {:g}", study.high);
  return t;
}

/// The figure of the fits. The windows of earlier experiments lie inside [W_f, W_2], so that their points are
/// drawn last, over the same points of the wider window.
analysis::Figure figure_of(const std::string& name, std::vector<Exponent> all, bool of_height) {
  std::stable_sort(all.begin(), all.end(), [](const Exponent& a, const Exponent& b) {
    return a.printed.has_value() < b.printed.has_value();
  });
  std::vector<Series> series;
  std::size_t number = 0;
  for (const Exponent& e : all) {
    if (!e.fit) continue;
    Series points{.title = fmt::format("{}: {} = {:.3f}{}", e.name, of_height ? "α_h" : "α", e.alpha().value,
                                       e.printed ? fmt::format(", paper {:.2f}", *e.printed) : ""),
                  .x = {},
                  .y = {}};
    for (std::size_t k = 0; k < e.points.size(); ++k) {
      const calibration::DataPoint& p = e.points[k];
      if (!(p.y > 0) || p.x * p.x < e.low || p.x * p.x > e.high) continue;
      points.x.push_back(p.x);
      points.y.push_back(e.measured.empty() ? Estimate{.value = p.y, .low = {}, .high = {}} : e.measured[k]);
    }
    Series line{.title = "", .x = {}, .y = {}, .line = true, .of = number++};
    for (const double x : {points.x.front(), points.x.back()}) {
      line.x.push_back(x);
      line.y.push_back({.value = e.fit->at(x), .low = {}, .high = {}});
    }
    series.push_back(points);
    series.push_back(line);
  }
  if (series.empty()) series.push_back({.title = "no window with enough points", .x = {}, .y = {}});
  return series_figure(
      {.name = name,
       .panel = 0,
       .title = of_height ? "Lift of the centre of mass, A = d, N = 4" : "Power laws of T_z, A = d, N = 4",
       .x = {.label = "V_p/(g d)^{1/2}", .logarithmic = true},
       .y = {.label = of_height ? "Δh_{cm}/d" : "T_z/(m g d)", .logarithmic = true},
       .caption = "Power laws over windows of W, unweighted least squares in the logarithms; [W_f, W_2] "
                  "contains the window of Warr et al. Bars: 95 % intervals, mostly smaller than the symbols.",
       .marks = "set key maxcols 1\n"},
      series);
}

Reproduction run(const Request& request, bool of_height) {
  const GasSize& size = gas_size_for(request);
  std::vector<calibration::DataPoint>
      own;  // read before the runs, so that an invalid table is reported early
  if (!request.data.empty()) own = of_user(request.data, of_height);
  Gas gas(request);
  std::vector<std::size_t> rough;
  for (const GasSystem& system : gas_systems())
    if (system.rough) rough.push_back(gas.add(system, size, size.rpm));
  Reproduction r;
  r.title = fmt::format("Bhateja et al. 2016, Table {}: {} over windows of W", of_height ? "II" : "I",
                        symbol(of_height));
  r.complete = gas.run();

  // Windows of the earlier experiments.
  std::vector<Exponent> fitted;
  for (const Study& study : studies(of_height)) {
    if (std::isnan(study.high)) {
      r.targets.push_back(target_of(study, nullptr, of_height));
      continue;
    }
    const auto& points = gas.points(rough[study.dimension == 2 ? 0 : 1]);
    const auto peak = peak_of(points);
    if (study.low == kFromPeak && !peak) {
      r.targets.push_back(target_of(study, nullptr, of_height));
      continue;
    }
    const double low = study.low == kFromPeak ? peak->grid * (1 - 1e-9) : study.low;
    fitted.push_back(exponent_of(fmt::format("{}, {}D rough", study.name, study.dimension),
                                 of_gas(points, of_height), low, std::min(study.high, kEndOfData)));
    fitted.back().printed = study.expected;
    fitted.back().measured = measured_of(points, of_height);
    std::optional<Exponent> other;
    if (std::string_view(study.name) == kWarr && peak) {
      other = exponent_of(study.name, of_gas(points, of_height),
                          of_height ? peak->grid * (1 - 1e-9) : kLowOfWarr, study.high);
      other->measured = measured_of(points, of_height);
    }
    r.targets.push_back(target_of(study, &fitted.back(), of_height, other ? &*other : nullptr));
  }
  // The universal window of the paper's sec. V, and the user's window.
  for (const std::size_t k : rough) {
    const auto peak = peak_of(gas.points(k));
    const auto w_2 = w_2_of(gas.points(k));
    const auto add = [&](const char* window, double low, double high) {
      fitted.push_back(exponent_of(gas.curve(k).name + window, of_gas(gas.points(k), of_height), low, high));
      fitted.back().measured = measured_of(gas.points(k), of_height);
    };
    if (peak && w_2) add(", [W_f, W_2]", peak->grid * (1 - 1e-9), *w_2 * (1 + 1e-9));
    if (request.window) add(", your window", request.window->first, request.window->second);
  }
  if (!own.empty()) {
    const auto window = request.window.value_or(std::pair(1e-300, 1e300));
    fitted.push_back(exponent_of("your data", own, window.first, window.second));
  }
  // Output.
  nlohmann::json exponents = nlohmann::json::array();
  r.table = fmt::format("  {} by least squares in the logarithms, unweighted\n", symbol(of_height));
  for (const Exponent& e : fitted) {
    r.table += fmt::format("  {:<34} {}\n", e.name, e.fit ? e.text() : e.why_not);
    nlohmann::json j = {{"name", e.name}, {"window", {e.low, e.high}}};
    if (e.fit) {
      const Estimate alpha = e.alpha();
      j["alpha"] = alpha.value;
      if (alpha.low && alpha.high) j["interval"] = {*alpha.low, *alpha.high};
      j["points"] = e.fit->n_used;
      j["solid"] = e.fit->n_zero;
    } else {
      j["absent"] = e.why_not;
    }
    exponents.push_back(j);
  }
  r.table += gas.table();
  r.measured = json_text({{"exponents", exponents}, {"points", nlohmann::json::parse(gas.as_json())}});
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  r.figures = {figure_of(of_height ? "p2-table2" : "p2-table1", fitted, of_height)};
  return r;
}

}  // namespace

Reproducible p2_table1() {
  Reproducible entry =
      gas_entry_of("p2-fig2", "p2-table1",
                   "exponents of T_z(V_p) in the windows of earlier experiments or in your own window",
                   [](const Request& request) { return run(request, false); });
  entry.takes_data = true;
  return entry;
}

Reproducible p2_table2() {
  Reproducible entry =
      gas_entry_of("p2-fig2", "p2-table2", "exponents of the centre-of-mass lift in the same windows",
                   [](const Request& request) { return run(request, true); });
  entry.takes_data = true;
  return entry;
}

}  // namespace twincell::reproduce
