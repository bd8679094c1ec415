#include "reproduce/gas.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/json_text.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// Results that any figure needs. All figures request the same list, so that they share their points.
constexpr const char* kResults =
    R"(["T_x", "T_y", "T_z", "T", "T_z_eq5", "T_z_field", "T_bar_z", "T_bar", "T_z_tau", "h_cm", "delta_h_cm", )"
    R"("delta_h_bar", "profile_z", "phi_z", "T_z_z", "T_z_frames_z", "T_z_instant_z", "T_z_volume", )"
    R"("phi_top", "phi_cm"])";

constexpr double kSigmaMetres = 0.005, kGravity = 9.81;

/// Largest fraction of time in contact at which the beads count as a gas.
constexpr double kHard = 0.1;

std::vector<int> coarse_rpm() {
  return {300, 400, 500, 600, 700, 800, 900, 1000, 1200, 1500, 2000, 2500, 3000, 3500, 4000};
}

/// Relative errors are half 95 % intervals, 2 standard errors.
const std::vector<GasSize>& sizes() {
  static const std::vector<GasSize> all = {{0, coarse_rpm(), 0.1, 300},
                                           {10, coarse_rpm(), 0.05, 1000},
                                           {25, all_rpm(), 0.02, 40000},
                                           {1e300, all_rpm(), 0.01, 200000}};
  return all;
}

Estimate number_of(const json& result) {
  Estimate e{.value = result["value"].get<double>(), .low = {}, .high = {}};
  const json interval = result.value("interval", json::object());
  // An end that is not finite is null.
  if (const json low = interval.value("low", json()); low.is_number()) e.low = low.get<double>();
  if (const json high = interval.value("high", json()); high.is_number()) e.high = high.get<double>();
  return e;
}

std::vector<double> numbers_of(const json& array) {
  std::vector<double> values;
  for (const json& element : array)
    values.push_back(element.is_number() ? element.get<double>() : std::nan(""));
  return values;
}

constexpr double kSameValue = 1e-9;  ///< relative difference below which two values of a key are the same

/// The arrays over height that Gas::as_json writes on request.
constexpr std::array kProfiles = {"profile_z", "phi_z", "T_z_z", "T_z_frames_z", "T_z_instant_z"};

/// A point as Gas::as_json writes it.
GasPoint point_of(const json& stored) {
  GasPoint p;
  p.at = stored.at("at").get<double>();
  p.id = stored.value("id", "");
  p.done = true;
  p.failed = stored.value("failed", "");
  p.cycles = stored.value("cycles", std::int64_t{0});
  p.contact_fraction = stored.value("contact_fraction", 0.0);
  if (stored.contains("until")) {
    p.until = stored["until"].value("text", "");
    p.precise = stored["until"].value("reached", false);
  }
  for (const auto& [name, value] : stored.items()) {
    if (value.is_array()) p.arrays[name] = numbers_of(value);
    if (!value.is_object() || !value.contains("value") || !value["value"].is_number()) continue;
    Estimate& e = p.scalars[name];
    e.value = value["value"].get<double>();
    if (const json interval = value.value("interval", json::array()); interval.size() == 2) {
      e.low = interval[0].get<double>();
      e.high = interval[1].get<double>();
    }
  }
  return p;
}

double half_width(const Estimate& e) {
  return e.low && e.high ? (*e.high - *e.low) / 2 : std::nan("");
}

}  // namespace

double w_of_rpm(double rpm) {
  const double omega = 2 * std::numbers::pi * rpm / 60;
  return kSigmaMetres / kGravity * omega * omega;
}

std::vector<int> all_rpm() {
  std::vector<int> all;
  for (int rpm = 300; rpm <= 4000; rpm += 100) all.push_back(rpm);
  return all;
}

std::string GasSystem::name() const {
  return fmt::format("{}D {}", dimension, rough ? "rough" : "smooth");
}
std::string GasSystem::preset() const {
  return fmt::format("bhateja-2016-{}-{}d", rough ? "rough" : "smooth", dimension);
}
const std::vector<GasSystem>& gas_systems() {
  static const std::vector<GasSystem> all = {{2, true}, {3, true}, {2, false}, {3, false}};
  return all;
}

const GasSize& gas_size_for(const Request& request, double share) {
  if (request.full || !request.stored.empty()) return sizes().back();
  const double core_minutes = request.minutes * request.threads / share;
  const GasSize* chosen = &sizes().front();
  for (const GasSize& size : sizes())
    if (core_minutes >= size.core_minutes) chosen = &size;
  return *chosen;
}

Reproducible gas_entry(const std::string& name, const std::string& what,
                       const std::function<Reproduction(const Request&)>& run) {
  return {.name = name, .what = what, .run = run, .shared_runs = "p2-runs", .judges_stored = true};
}

Reproducible gas_entry_of(const std::string& of, const std::string& name, const std::string& what,
                          const std::function<Reproduction(const Request&)>& run) {
  Reproducible entry = gas_entry(name, what + fmt::format(" (runs of {})", of), run);
  entry.runs_like = of;
  return entry;
}

Estimate quotient(const Estimate& a, const Estimate& b) {
  Estimate q{.value = a.value / b.value, .low = {}, .high = {}};
  const double half = std::abs(q.value) * std::hypot(half_width(a) / a.value, half_width(b) / b.value);
  if (!std::isfinite(half)) return q;
  q.low = q.value - half;
  q.high = q.value + half;
  return q;
}

std::optional<Estimate> GasPoint::get(const std::string& name) const {
  const auto found = scalars.find(name);
  if (found == scalars.end()) return std::nullopt;
  return found->second;
}

bool GasPoint::solid() const {
  const auto t = get("T_bar_z");
  return t && t->value < kSolid;
}

Gas::Gas(const Request& request)
    : request_(request),
      store_(request.runs,
             request.stored.empty() ? sweep::Store::Access::write : sweep::Store::Access::read) {
  if (request.stored.empty()) return;
  const json stored = json::parse(request.stored);
  for (const json& point : stored.is_object() ? stored.at("points") : stored)
    stored_[point.at("curve").get<std::string>()].push_back(point_of(point));
}

std::size_t Gas::add(const GasCurve& curve) {
  Runs& runs = runs_.emplace_back();
  runs.curve = curve;
  if (!request_.stored.empty()) {
    // The stored points, and places without a result for the values that the document lacks.
    runs.points = stored_[curve.name];
    for (const double value : curve.values)
      if (std::none_of(runs.points.begin(), runs.points.end(),
                       [&](const GasPoint& p) { return std::abs(p.at / value - 1) < kSameValue; }))
        runs.points.emplace_back().at = value;
    std::sort(runs.points.begin(), runs.points.end(),
              [](const GasPoint& a, const GasPoint& b) { return a.at < b.at; });
    return runs_.size() - 1;
  }
  // The split integrator at n = 6.37 is as accurate as Verlet at n = 50 in every measured quantity except e
  // averaged over entry phases (docs/accuracy.md).
  const auto plan_of = [&](const std::vector<double>& values, int cycles) {
    std::string list;
    for (const double value : values) list += fmt::format("{}{:.17g}", list.empty() ? "" : ", ", value);
    return sweep::read_plan_text(
        fmt::format("seed = {}\nresults = {}\n[scene]\n{}\ntime.integrator = \"split\"\n"
                    "time.steps_per_contact = 6.37\ntime.discard = {}\ntime.cycles = {}\n"
                    "until.quantity = \"{}\"\nuntil.relative_error = {}\nuntil.absolute_error = 3e-4\n"
                    "[axes]\n{} = [{}]\n",
                    request_.seed, curve.results.empty() ? kResults : curve.results, curve.scene,
                    curve.discard, cycles, curve.quantity, curve.relative_error, curve.key, list),
        curve.name);
  };
  std::vector<double> creeping, others;
  for (const double value : curve.values)
    (curve.key == "drive.k_m" && value < kCreeping ? creeping : others).push_back(value);
  runs.curve.values = creeping;  // in the order of the schedules
  runs.curve.values.insert(runs.curve.values.end(), others.begin(), others.end());
  for (const auto& [some, cycles] :
       {std::pair{&creeping, std::min(curve.cycles, kCyclesOfCreeping)}, std::pair{&others, curve.cycles}}) {
    if (some->empty()) continue;
    runs.plans.push_back(plan_of(*some, cycles));
    runs.schedules.emplace_back(runs.plans.back(), store_);
  }
  read(runs);
  return runs_.size() - 1;
}

std::size_t Gas::add(const GasSystem& system, const GasSize& size, const std::vector<int>& rpm) {
  GasCurve curve{.name = system.name(),
                 .scene = fmt::format("preset = \"{}\"\n{}", system.preset(), kAbrupt),
                 .relative_error = size.relative_error,
                 .cycles = size.cycles};
  for (const int f : rpm) curve.values.push_back(w_of_rpm(f));
  return add(curve);
}

bool Gas::run() {
  if (!request_.stored.empty()) return true;
  std::vector<sweep::Schedule*> schedules;
  for (Runs& runs : runs_)
    for (sweep::Schedule& schedule : runs.schedules) schedules.push_back(&schedule);
  announce(schedules, request_.farm(), *request_.watch);
  const bool complete = run_here(schedules, store_, request_.farm(), *request_.watch);
  for (Runs& runs : runs_) read(runs);
  return complete;
}

void Gas::read(Runs& runs) const {
  runs.points.clear();
  std::vector<const sweep::Curve*> curves;  // one point each, because only the key varies
  for (const sweep::Schedule& schedule : runs.schedules)
    for (const sweep::Curve& curve : schedule.curves()) curves.push_back(&curve);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    GasPoint p;
    p.at = runs.curve.values[k];
    p.id = curves[k]->points.front().id;
    if (const auto& text = curves[k]->results.front()) {
      const json result = json::parse(*text);
      p.done = true;
      p.failed = result.value("failed", "");
      p.cycles = result.value("n_cycles", std::int64_t{0});
      p.contact_fraction = result.value("contact_fraction", 0.0);
      if (result.contains("until")) {
        p.until = result.at("until").at("text").get<std::string>();
        p.precise = result.at("until").at("reached").get<bool>();
      }
      const json results = result.value("results", json::object());  // items() of a temporary would dangle
      for (const auto& [name, value] : results.items()) {
        if (!value.contains("value") || value["value"].is_null()) continue;
        if (value["value"].is_number()) p.scalars[name] = number_of(value);
        if (value["value"].is_array()) p.arrays[name] = numbers_of(value["value"]);
      }
    }
    runs.points.push_back(std::move(p));
  }
}

std::string Gas::table() const {
  std::string s =
      "  T_bar_z = m <w'^2>/(m V_p^2), w' about the centre of mass of the instant; eq5: (m/2) <w'^2> as "
      "printed;\n"
      "  field: m <w'^2> about the mean velocity at that phase and height; all in m V_p^2; 95 % intervals\n";
  for (const Runs& runs : runs_) {
    if (std::none_of(runs.points.begin(), runs.points.end(), [](const GasPoint& p) { return p.done; })) {
      s += fmt::format("  {}: none of {} points begun\n", runs.curve.name, runs.points.size());
      continue;
    }
    s += fmt::format("  {}\n  {:>9} {:>26} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>8}  {}\n", runs.curve.name,
                     runs.curve.key == "drive.k_m" ? "W" : runs.curve.key, "T_bar_z", "eq5", "field",
                     "T_bar_x", "T_bar", "dh_bar", "phi_top", "touching", "cycles (tau)");
    for (const GasPoint& p : runs.points) {
      if (!p.done && !request_.stored.empty()) continue;
      if (!p.done || !p.failed.empty()) {
        s += fmt::format("  {:>9.4g} {}\n", p.at, p.done ? p.failed : "not begun");
        continue;
      }
      const auto cell = [&](const char* name, double scale) {
        const auto e = p.get(name);
        return e ? fmt::format("{:.4g}", e->value * scale) : std::string("-");
      };
      // T_bar_z/T_z is 1/V_p^2, which scales the other temperatures.
      const auto t = p.get("T_z"), bar = p.get("T_bar_z");
      const double per = t && bar && t->value > 0 ? bar->value / t->value : std::nan("");
      s += fmt::format(
          "  {:>9.4g} {:>26} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>8.2g}  {}\n", p.at,
          bar ? bar->text() : "-", cell("T_z_eq5", per), cell("T_z_field", per), cell("T_x", per),
          cell("T_bar", 1), cell("delta_h_bar", 1), p.contact_fraction > kHard ? "-" : cell("phi_top", 1),
          p.contact_fraction,
          fmt::format("{} ({}){}", p.cycles, cell("T_z_tau", 1), p.precise ? "" : ", ended by the cap"));
    }
  }
  return s;
}

std::string Gas::runs_text() const {
  std::int64_t least = std::numeric_limits<std::int64_t>::max(), most = 0;
  for (const Runs& runs : runs_)
    for (const GasPoint& p : runs.points)
      if (p.done && p.failed.empty()) {
        least = std::min(least, p.cycles);
        most = std::max(most, p.cycles);
      }
  if (most == 0) return "no run";
  return least == most ? fmt::format("one run a point, {} cycles", most)
                       : fmt::format("one run a point, {} to {} cycles", least, most);
}

std::string Gas::as_json(bool with_profiles) const {
  nlohmann::json all = nlohmann::json::array();
  for (const Runs& runs : runs_)
    for (const GasPoint& p : runs.points) {
      if (!p.done) continue;
      nlohmann::json j = {{"curve", runs.curve.name},
                          {"key", runs.curve.key},
                          {"at", p.at},
                          {"id", p.id},
                          {"cycles", p.cycles},
                          {"contact_fraction", p.contact_fraction}};
      if (!p.failed.empty()) j["failed"] = p.failed;
      if (!p.until.empty()) j["until"] = {{"reached", p.precise}, {"text", p.until}};
      for (const auto& [name, e] : p.scalars) {
        j[name] = {{"value", e.value}};
        if (e.low && e.high) j[name]["interval"] = {*e.low, *e.high};
      }
      for (const char* name : kProfiles)
        if (const auto found = p.arrays.find(name); with_profiles && found != p.arrays.end())
          j[name] = found->second;
      all.push_back(j);
    }
  return json_text(all);
}

std::vector<std::string> Gas::conditions() const {
  int discard_least = 1000000, discard_most = 0;
  std::size_t abrupt = 0;
  for (const Runs& runs : runs_) {
    abrupt += runs.curve.scene.find(kAbrupt) != std::string::npos ? 1 : 0;
    discard_least = std::min(discard_least, runs.curve.discard);
    discard_most = std::max(discard_most, runs.curve.discard);
  }
  const char* beginnings =
      abrupt == 0 ? "with the beads moving along"
      : abrupt == runs_.size()
          ? "abruptly, as A sin(omega t), with the beads at rest"
          : "abruptly, as A sin(omega t), with the beads at rest, unless a curve says otherwise";
  return {
      fmt::format("each point is one run; its seed is drawn from the master seed {} and its scene",
                  request_.seed),
      "contacts: linear spring, tension allowed; unless varied k_n = 1e6 m g/d, e = 0.9 for beads and walls, "
      "rough: dashpot with c_t = c_n and Coulomb slider without history, mu = 0.4; none of k_n, c_t is in "
      "the paper",
      "n = 6.37 steps per contact, split at contact entry and exit, where steps are taken; from W = 10 on "
      "beads fly from contact to contact and steps act only where three meet (docs/event_driven.md)",
      fmt::format("start: random, settled at rest; the plate begins {}; {} cycles discarded", beginnings,
                  discard_least == discard_most ? fmt::format("{}", discard_most)
                                                : fmt::format("{} to {}", discard_least, discard_most)),
      "T_z = m <w'^2> about the centre of mass of the instant, mean over beads and 20 phases a cycle",
      "errors: 95 % intervals of series correlated over tau, which the table states in cycles "
      "(docs/statistics.md)"};
}

std::vector<std::string> Gas::cheaper() const {
  std::vector<std::string> s = {
      "where steps are taken, split at n = 6.37 per contact: as accurate as Verlet at n = 50 in every "
      "measured "
      "quantity except e averaged over entry phases (docs/accuracy.md); the paper states neither integrator "
      "nor "
      "step"};
  std::size_t done = 0, all = 0, capped = 0, failed = 0, solid = 0, soft = 0;
  double loosest = 0;
  for (const Runs& runs : runs_) {
    loosest = std::max(loosest, runs.curve.relative_error);
    for (const GasPoint& p : runs.points) {
      ++all;
      done += p.done ? 1 : 0;
      failed += p.failed.empty() ? 0 : 1;
      capped += p.done && p.failed.empty() && !p.precise ? 1 : 0;
      solid += p.solid() ? 1 : 0;
      soft += p.contact_fraction > kHard && !p.solid() ? 1 : 0;
    }
  }
  s.push_back(
      fmt::format("{} of {} points; each ends when half of its 95 % interval is {:g} % of its value at most",
                  done, all, 100 * loosest));
  if (capped > 0) s.push_back(fmt::format("{} of them were ended by the cap of cycles before that", capped));
  if (solid > 0)
    s.push_back(fmt::format("{} are solid, T_bar_z < {:g}: left out of all fits", solid, kSolid));
  if (soft > 0)
    s.push_back(fmt::format(
        "in {} points the beads are in contact for more than 0.1 of the time: not a gas of hard beads",
        soft));
  if (failed > 0) s.push_back(fmt::format("{} failed, see the table", failed));
  return s;
}

Series series_of(const std::string& title, const std::vector<GasPoint>& points, const std::string& result) {
  Series s{.title = title, .x = {}, .y = {}};
  for (const GasPoint& p : points)
    if (const auto e = p.get(result)) {
      s.x.push_back(p.at);
      s.y.push_back(*e);
    }
  return s;
}

void add_series(std::vector<Series>& all, const std::string& title, const std::vector<GasPoint>& points,
                const std::string& result, const std::function<Estimate(const Estimate&, double)>& of_value) {
  const auto number = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [](const Series& s) { return !s.line && !s.solid; }));
  Series gas{.title = title, .x = {}, .y = {}},
      solid{.title = title + ", solid", .x = {}, .y = {}, .of = number, .solid = true};
  for (const GasPoint& p : points)
    if (const auto e = p.get(result)) {
      Series& s = p.solid() ? solid : gas;
      s.x.push_back(p.at);
      s.y.push_back(of_value ? of_value(*e, p.at) : *e);
    }
  all.push_back(gas);
  if (!solid.x.empty()) all.push_back(solid);
}

analysis::figure_style::PlotAxis w_axis() {
  return {.label = "W = V_p^2/(d g)", .logarithmic = true};
}

analysis::Figure series_figure(SeriesFigure figure, const std::vector<Series>& all) {
  analysis::Figure f{
      .name = figure.name, .title = figure.title, .caption = figure.caption, .width = 640, .height = 480};
  std::vector<std::string> clauses;
  std::size_t points = 0, lines = 0;
  bool any_solid = false;
  for (const Series& s : all) {
    const std::size_t turn = s.of.value_or(s.line ? lines : points);
    (s.line ? lines : points) += s.solid ? 0 : 1;
    if (s.x.empty()) continue;
    f.data += "# " + s.title + "\n";
    bool bars = false;
    for (std::size_t k = 0; k < s.x.size(); ++k) {
      const double low = s.y[k].low.value_or(s.y[k].value), high = s.y[k].high.value_or(s.y[k].value);
      f.data += fmt::format("{} {} {} {}\n", s.x[k], s.y[k].value, low, high);
      bars = bars || low < high;
      figure.x.show(s.x[k]);
      for (const double y : {low, s.y[k].value, high}) figure.y.show(y);
    }
    f.data += "\n\n";
    const std::string look =
        s.line    ? fmt::format("lines lt {} lw {} dt {}", turn + 1, analysis::figure_style::kCurve, s.dash)
        : s.solid ? fmt::format("points lt {} pt {}", turn + 1,
                                analysis::figure_style::unfilled(analysis::figure_style::series_point(turn)))
                  : fmt::format("{} lt {}", bars ? "yerrorbars" : "points", turn + 1);
    clauses.push_back(
        fmt::format("'{}.dat' index {} using {} with {} {}", f.name, clauses.size(),
                    s.line || s.solid || !bars ? "1:2" : "1:2:3:4", look,
                    s.solid || s.title.empty() ? "notitle" : fmt::format("title '{}'", s.title)));
    any_solid = any_solid || s.solid;
  }
  if (clauses.empty()) {  // gnuplot rejects an empty plot
    f.data = "# nothing measured\n";
    f.plot = analysis::figure_style::axes(figure.x, figure.y) +
             "set label 'not measured at this budget' at graph 0.5,0.5 center\nplot NaN notitle\n";
    return f;
  }
  if (any_solid) clauses.emplace_back("keyentry with points pt 6 lc rgb '#555555' title 'open: solid bed'");
  clauses.insert(clauses.end(), figure.entries.begin(), figure.entries.end());
  f.plot = analysis::figure_style::axes(figure.x, figure.y) +
           analysis::figure_style::panel_title(figure.panel, figure.title) + figure.marks +
           fmt::format("plot {}\n", fmt::join(clauses, ", \\\n     "));
  return f;
}

std::optional<Peak> peak_of(const std::vector<GasPoint>& points) {
  std::vector<std::pair<double, double>> t;
  for (const GasPoint& p : points)
    if (const auto e = p.get("T_bar_z"); e && !p.solid()) t.emplace_back(p.at, e->value);
  if (t.size() < 3) return std::nullopt;
  const auto top = static_cast<std::size_t>(
      std::max_element(t.begin(), t.end(), [](const auto& a, const auto& b) { return a.second < b.second; }) -
      t.begin());
  Peak peak{.w = t[top].first, .grid = t[top].first, .height = t[top].second, .inside = false};
  if (top > 0) peak.left = t[top - 1].first;
  if (top + 1 < t.size()) peak.right = t[top + 1].first;
  if (!peak.left || !peak.right) return peak;
  peak.inside = true;
  const double x0 = std::log(t[top - 1].first), x1 = std::log(t[top].first), x2 = std::log(t[top + 1].first);
  const double left = (t[top].second - t[top - 1].second) / (x1 - x0);
  const double right = (t[top + 1].second - t[top].second) / (x2 - x1);
  const double curvature = (right - left) / (x2 - x0);
  if (curvature < 0) peak.w = std::exp((x0 + x1) / 2 - left / (2 * curvature));
  return peak;
}

std::optional<Estimate> flat_from(const Series& s, bool errors_count) {
  constexpr double kNearly = 0.05;
  std::optional<Estimate> from;
  for (std::size_t k = s.x.size(); k-- > 0;) {
    const double last = s.y.back().value;
    const Estimate& e = s.y[k];
    const double nearest =
        errors_count ? std::clamp(last, e.low.value_or(e.value), e.high.value_or(e.value)) : e.value;
    if (std::abs(nearest - last) > kNearly * last) break;
    from = Estimate{s.x[k], k > 0 ? std::optional(s.x[k - 1]) : std::nullopt, s.x[k]};
  }
  return from;
}

std::optional<double> w_2_of(const std::vector<GasPoint>& points) {
  const auto from = flat_from(series_of("", points, "T_bar_z"), true);
  return from ? std::optional(from->value) : std::nullopt;
}

double table_3(int dimension, bool algebraic, double w) {
  if (dimension == 2)
    return algebraic ? 0.282 * (1 + 2.07 * std::pow(w, -0.656)) : 0.327 * (1 + 1.022 * std::exp(-0.131 * w));
  return algebraic ? 0.054 * (1 + 7.98 * std::pow(w, -0.622)) : 0.092 * (1 + 2.695 * std::exp(-0.124 * w));
}

}  // namespace twincell::reproduce
