#include "reproduce/p1_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "reproduce/alternatives.hpp"
#include "reproduce/p1_scene.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// Extent of the study at a given budget.
struct Size {
  double core_minutes;
  std::size_t heights;       ///< how many of kHeights
  int cycles, seeds, every;  ///< every: use every n-th point
};
constexpr std::array<int, 3> kHeights = {20, 40, 60};
constexpr int kPaperCycles = 200;
constexpr double kOnsetWidth = 0.2;  ///< in Gamma; about the spacing of points

const Size& size_for(const Request& request, double share) {
  static constexpr std::array<Size, 7> all = {{{0, 1, 30, 1, 4},
                                               {1, 1, 60, 1, 2},
                                               {6, 1, 200, 1, 1},
                                               {20, 1, 200, 3, 1},
                                               {120, 2, 200, 3, 1},
                                               {500, 3, 200, 3, 1},
                                               {1e300, 3, 200, 10, 1}}};
  if (request.full) return all.back();
  const Size* chosen = &all.front();
  for (const Size& size : all)
    if (request.minutes * request.threads * share >= size.core_minutes) chosen = &size;
  return *chosen;
}

/// Values of Gamma, for K_m from 0.8 to 30, dense around the onsets of slips and convection.
const std::vector<double>& gammas(bool random) {
  static const std::vector<double> of_random = {0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8,
                                                1.9, 2.0, 2.2, 2.4, 2.7, 3.0, 3.5, 4.2, 5.0, 5.5};
  static const std::vector<double> of_crystal = {0.9, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.3, 2.4, 2.5,
                                                 2.6, 2.7, 2.8, 2.9, 3.0, 3.2, 3.5, 4.0, 4.5, 5.0, 5.5};
  return random ? of_random : of_crystal;
}

/// Every `every`-th value, in the order of van der Corput's sequence: any first part covers the whole range,
/// so that an early stop leaves a coarse curve instead of a truncated one.
std::vector<double> spread(const std::vector<double>& all, int every) {
  std::vector<double> some;
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(every)) some.push_back(all[i]);
  std::vector<std::pair<double, double>> keyed;
  for (std::size_t i = 0; i < some.size(); ++i) {
    double key = 0, digit = 0.5;
    for (std::size_t k = i; k > 0; k /= 2, digit /= 2) key += digit * static_cast<double>(k % 2);
    keyed.emplace_back(key, 0);
  }
  // The index of the i-th value is the rank of the i-th key.
  std::vector<double> ordered;
  for (const auto& [key, unused] : keyed) {
    const auto rank =
        std::count_if(keyed.begin(), keyed.end(), [bound = key](const auto& k) { return k.first < bound; });
    ordered.push_back(some[static_cast<std::size_t>(rank)]);
  }
  return ordered;
}

sweep::Plan plan_of(const Size& size, const P1Run& run, std::uint64_t seed) {
  return sweep::read_plan_text(
      fmt::format(
          "seed = {}\nresults = [\"T_g\", \"p_s\", \"slips\", \"s_b\", \"s_c\", \"s_j_growth_late\"]\n"
          "{}[axes]\ndrive.gamma = [{:.2f}]\nseeds = {}\n",
          seed, p1_scene(run), fmt::join(spread(gammas(run.start == "random"), size.every), ", "),
          size.seeds),
      fmt::format("sweep, {}, {} layers", run.start, run.layers));
}

/// The value of a result, if it has one.
std::optional<double> value_of(const json& results, const char* name) {
  const json r = results.value(name, json::object());
  if (!r.contains("value") || !r["value"].is_number()) return std::nullopt;
  return r["value"].get<double>();
}

StrengthSweep strength_sweep_of(const std::string& start, const sweep::Schedule& schedule) {
  std::vector<SweepRun> runs;
  for (const sweep::Curve& curve : schedule.curves())
    for (const auto& text : curve.results) {
      if (!text) continue;
      const json results = json::parse(*text).value("results", json::object());
      const auto t_g = value_of(results, "T_g"), s_b = value_of(results, "s_b"),
                 s_c = value_of(results, "s_c"), slips = value_of(results, "slips");
      if (!t_g || !s_b || !s_c) continue;
      Estimate temperature{*t_g, {}, {}};
      const json interval = results.at("T_g").value("interval", json::object());
      // An end that is not finite is null.
      if (const json low = interval.value("low", json()); low.is_number())
        temperature.low = low.get<double>();
      if (const json high = interval.value("high", json()); high.is_number())
        temperature.high = high.get<double>();
      runs.push_back({std::stod(curve.values.front()), temperature, *s_b, *s_c, slips.value_or(0),
                      slips ? results["slips"].value("n", 0.0) : 0});
    }
  return make_strength_sweep(start, runs);
}

std::string or_dash(const std::optional<Estimate>& e) {
  return e ? e->text() : "not found";
}

json as_json(const std::optional<Estimate>& e) {
  if (!e) return nullptr;
  const auto number = [](const std::optional<double>& v) { return v ? json(*v) : json(nullptr); };
  return {{"value", e->value}, {"low", number(e->low)}, {"high", number(e->high)}};
}

}  // namespace

Estimate SweepPoint::mean_temperature() const {
  if (temperature.size() == 1) return temperature.front();
  std::vector<double> values;
  for (const Estimate& t : temperature) values.push_back(t.value);
  Estimate e;
  for (const double t : values) e.value += t / static_cast<double>(values.size());
  if (const auto interval = analysis::mean_interval(values, "runs")) {
    e.low = interval->low;
    e.high = interval->high;
  }
  return e;
}

Estimate SweepPoint::slip_probability() const {
  Estimate e{p_s(), {}, {}};
  if (const auto interval = analysis::mean_interval(p_s_of_runs, "runs")) {
    e.low = interval->low;
    e.high = interval->high;
  }
  return e;
}

StrengthSweep make_strength_sweep(const std::string& start, const std::vector<SweepRun>& runs) {
  std::map<double, SweepPoint> points;
  for (const SweepRun& run : runs) {
    SweepPoint& point = points[run.gamma];
    point.gamma = run.gamma;
    ++point.runs;
    point.temperature.push_back(run.temperature);
    point.bouncing += run.s_b > analysis::kBouncingThreshold ? 1 : 0;
    point.convecting += run.s_c > analysis::kConvectionThreshold ? 1 : 0;
    point.slips += run.slips;
    point.eligible += run.eligible;
    if (run.eligible > 0) point.p_s_of_runs.push_back(run.slips / run.eligible);
  }
  std::vector<SweepPoint> rising;
  rising.reserve(points.size());
  for (const auto& [gamma, point] : points) rising.push_back(point);
  return find_regions(start, std::move(rising));
}

StrengthSweep find_regions(const std::string& start, std::vector<SweepPoint> points) {
  StrengthSweep sweep;
  sweep.start = start;
  sweep.points = std::move(points);
  std::vector<sweep::Trial> trials;
  for (const SweepPoint& point : sweep.points)
    for (std::size_t k = 0; k < point.runs; ++k) trials.push_back({point.gamma, k < point.convecting});
  if (sweep.points.size() >= 4) {
    const sweep::Onset onset =
        estimate_onset(trials, sweep.points.front().gamma, sweep.points.back().gamma, kOnsetWidth);
    if (onset.value) {
      Estimate e{*onset.value * *onset.value, {}, {}};
      if (onset.low) e.low = *onset.low * *onset.low;
      if (onset.high) e.high = *onset.high * *onset.high;
      sweep.convection = e;
    }
  }
  const auto slipping =
      std::find_if(sweep.points.begin(), sweep.points.end(), [](const SweepPoint& r) { return r.slips > 0; });
  if (slipping != sweep.points.begin() && slipping != sweep.points.end() &&
      std::prev(slipping)->bouncing > 0) {
    const double low = std::prev(slipping)->k_m(), high = slipping->k_m();
    sweep.first_slips = Estimate{std::sqrt(low * high), low, high};
  }
  return sweep;
}

namespace {

std::string runs_text_of(const StrengthSweeps& sweeps, int cycles) {
  std::size_t least = 0, most = 0;
  for (const HeightSweeps& height : sweeps.heights)
    for (const StrengthSweep* sweep : {&height.random, &height.crystal})
      for (const SweepPoint& p : sweep->points) {
        least = most == 0 ? p.runs : std::min(least, p.runs);
        most = std::max(most, p.runs);
      }
  if (most == 0) return "no run";
  std::string s = least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most);
  s += most == 1 ? " run a point" : " runs a point";
  return cycles > 0 ? s + fmt::format(", {} cycles", cycles) : s;
}

/// The sweeps of a document that json_of() wrote.
StrengthSweeps stored_sweeps(const std::string& stored) {
  StrengthSweeps all;
  all.complete = true;
  const json document = json::parse(stored);
  for (const json& sweep : document) {
    std::vector<SweepPoint> points;
    for (const json& p : sweep.at("points")) {
      SweepPoint& point = points.emplace_back();
      point.gamma = p.at("gamma").get<double>();
      point.slips = p.at("slips").get<double>();
      point.eligible = p.at("bead_periods").get<double>();
      point.p_s_of_runs = p.value("p_s_of_runs", std::vector<double>());
      point.runs = p.at("runs").get<std::size_t>();
      point.bouncing = p.at("bouncing").get<std::size_t>();
      point.convecting = p.at("convecting").get<std::size_t>();
      for (const json& t : p.at("T_g")) {
        Estimate& e = point.temperature.emplace_back();
        e.value = t.at("value").get<double>();
        if (t.at("low").is_number()) e.low = t.at("low").get<double>();
        if (t.at("high").is_number()) e.high = t.at("high").get<double>();
      }
    }
    const int layers = sweep.at("layers").get<int>();
    if (all.heights.empty() || all.heights.back().layers != layers)
      all.heights.push_back({.layers = layers, .random = {}, .crystal = {}});
    const auto start = sweep.at("start").get<std::string>();
    (start == "random" ? all.heights.back().random : all.heights.back().crystal) =
        find_regions(start, std::move(points));
  }
  if (all.heights.empty()) all.heights.push_back({.layers = kHeights.front(), .random = {}, .crystal = {}});
  all.runs_text = runs_text_of(all, 0);
  return all;
}

}  // namespace

StrengthSweeps strength_sweeps(const Request& request, const std::string& keys, double share) {
  if (!request.stored.empty()) return stored_sweeps(request.stored);
  const Size& size = size_for(request, share);
  const sweep::Store store(request.runs);
  StrengthSweeps all;
  all.complete = true;
  for (const int layers : std::span(kHeights).first(size.heights)) {
    const P1Run random{layers, "random", size.cycles, 10, keys},
        crystal{layers, "crystal_a", size.cycles, 10, keys};
    const sweep::Plan of_random = plan_of(size, random, request.seed),
                      of_crystal = plan_of(size, crystal, request.seed);
    sweep::Schedule r(of_random, store), c(of_crystal, store);
    // Once the time has run out, only results of earlier calls are read.
    if (all.complete) {
      announce({&r, &c}, request.farm(), *request.watch);
      all.complete = run_here({&r, &c}, store, request.farm(), *request.watch);
    }
    HeightSweeps height{.layers = layers,
                        .random = strength_sweep_of("random", r),
                        .crystal = strength_sweep_of("crystal_a", c)};
    if (all.heights.empty() || !height.random.points.empty() || !height.crystal.points.empty())
      all.heights.push_back(std::move(height));
  }
  all.runs_text = runs_text_of(all, size.cycles);
  all.conditions = p1_conditions({kHeights.front(), "crystal_a", size.cycles, 10, keys});
  all.conditions.emplace_back(
      "T_g* is a time average, from 400 samples a cycle, which does not depend on the phases of the frames");
  std::vector<int> measured;
  for (const HeightSweeps& height : all.heights) measured.push_back(height.layers);
  all.conditions.push_back(
      fmt::format("N_l = {} (the paper does not state that of Figs. 4 and 5); {} of each start and strength, "
                  "seeds drawn from the master seed {}",
                  fmt::join(measured, ", "), plural(size.seeds, "run"), request.seed));
  if (all.heights.size() > 1)
    all.conditions.push_back(fmt::format(
        "both figures show one bed: the verdicts are those at N_l = {}, the height that meets most "
        "of their targets",
        all.heights[counted_height(all)].layers));
  all.conditions.emplace_back(
      "A1: no slip; B: above the onset of convection, s_c > sigma, by logistic regression over runs; A2 in "
      "between");
  all.cheaper.push_back(p1_cheaper_steps());
  if (size.cycles < kPaperCycles)
    all.cheaper.push_back(
        fmt::format("{} cycles, where the paper counts slips over {} and s_c is defined by "
                    "as many: onsets come out high",
                    size.cycles, kPaperCycles));
  if (size.every > 1)
    all.cheaper.push_back(
        fmt::format("every {} strength of the drive", size.every == 2 ? "second" : "fourth"));
  if (size.seeds < 4)
    all.cheaper.push_back(
        fmt::format("{}: random beds differ by as much as onsets do", plural(size.seeds, "seed")));
  return all;
}

namespace {

std::string text_of(const StrengthSweeps& sweeps) {
  std::string text;
  for (const HeightSweeps& height : sweeps.heights)
    for (const StrengthSweep* l : {&height.random, &height.crystal}) {
      text += fmt::format("  {}\n  {:>6} {:>7} {:>5} {:>24} {:>10} {:>20}\n", title_of(*l, height.layers),
                          "Gamma", "K_m", "runs", "T_g*", "convecting", "slips");
      for (const SweepPoint& r : l->points)
        text += fmt::format("  {:6.2f} {:7.3f} {:5} {:>24} {:>10} {:>20}\n", r.gamma, r.k_m(), r.runs,
                            r.mean_temperature().text(), r.convecting,
                            fmt::format("{:.0f} of {:.0f}", r.slips, r.eligible));
      text += fmt::format("  convection from K_m {}; first slips at K_m {}\n", or_dash(l->convection),
                          or_dash(l->first_slips));
    }
  return text;
}

json json_of(const StrengthSweep& sweep, int layers) {
  json points = json::array();
  for (const SweepPoint& r : sweep.points) {
    json temperatures = json::array();
    for (const Estimate& t : r.temperature) temperatures.push_back(as_json(t));
    points.push_back({{"gamma", r.gamma},
                      {"k_m", r.k_m()},
                      {"T_g", temperatures},
                      {"slips", r.slips},
                      {"bead_periods", r.eligible},
                      {"p_s_of_runs", r.p_s_of_runs},
                      {"runs", r.runs},
                      {"bouncing", r.bouncing},
                      {"convecting", r.convecting}});
  }
  return {{"start", sweep.start},
          {"layers", layers},
          {"points", points},
          {"convection_k_m", as_json(sweep.convection)},
          {"first_slips_k_m", as_json(sweep.first_slips)}};
}

std::string json_of(const StrengthSweeps& sweeps) {
  json all = json::array();
  for (const HeightSweeps& height : sweeps.heights)
    for (const StrengthSweep* l : {&height.random, &height.crystal})
      all.push_back(json_of(*l, height.layers));
  return json_text(all);
}

/// The targets of a figure at each height.
std::vector<Alternative> at_heights(const StrengthSweeps& sweeps,
                                    std::vector<Target> (*targets_at)(const HeightSweeps&)) {
  std::vector<Alternative> all;
  for (const HeightSweeps& height : sweeps.heights)
    all.push_back({fmt::format("N_l = {}", height.layers), targets_at(height)});
  return all;
}

}  // namespace

std::size_t counted_height(const StrengthSweeps& sweeps) {
  std::vector<Alternative> both = at_heights(sweeps, temperature_targets);
  const std::vector<Alternative> of_slips = at_heights(sweeps, slip_targets);
  for (std::size_t i = 0; i < both.size(); ++i)
    both[i].targets.insert(both[i].targets.end(), of_slips[i].targets.begin(), of_slips[i].targets.end());
  return meets_most(both);
}

std::vector<Target> targets_at_heights(const StrengthSweeps& sweeps,
                                       std::vector<Target> (*targets_at)(const HeightSweeps&)) {
  return stating_all(at_heights(sweeps, targets_at), counted_height(sweeps));
}

Reproduction reproduction_of(const StrengthSweeps& sweeps, const std::string& title) {
  Reproduction r;
  r.title = title;
  r.complete = sweeps.complete;
  r.conditions = sweeps.conditions;
  r.cheaper = sweeps.cheaper;
  r.runs = sweeps.runs_text;
  r.table = text_of(sweeps);
  r.measured = json_of(sweeps);
  return r;
}

std::optional<calibration::CurveFit> fitted(const std::string& law,
                                            const std::vector<calibration::DataPoint>& points) {
  try {
    return calibration::fit_curve(calibration::law_named(law), points);
  } catch (const Error&) {
    return std::nullopt;
  }
}

Estimate parameter(const calibration::CurveFit& fit, const std::string& name) {
  const auto at = std::find(fit.fit.names.begin(), fit.fit.names.end(), name) - fit.fit.names.begin();
  const auto i = static_cast<std::size_t>(at);
  Estimate e{fit.fit.values[i], {}, {}};
  if (fit.intervals[i]) {
    e.low = fit.intervals[i]->low;
    e.high = fit.intervals[i]->high;
  }
  return e;
}

namespace {
constexpr const char *kRandomColour = analysis::colours::kGreen, *kCrystalColour = analysis::colours::kBlue;
constexpr const char* kBorder = "lw 1 dt 2 lc rgb '#666666'";
}  // namespace

std::string title_of(const StrengthSweep& sweep, int layers) {
  return fmt::format("{}, N_l = {}", sweep.is_random() ? "random" : "crystal", layers);
}

const char* colour_of(const StrengthSweep& sweep) {
  return sweep.is_random() ? kRandomColour : kCrystalColour;
}
int symbol_of(const StrengthSweep& sweep) {
  return sweep.is_random() ? analysis::figure_style::kTriangle : analysis::figure_style::kCircle;
}
std::string border_of_region(double x) {
  return fmt::format("set arrow from first {0:.5g},graph 0 to first {0:.5g},graph 1 nohead {1}\n", x,
                     kBorder);
}
std::string key_of_starts() {
  return fmt::format(
      "keyentry with points pt {} lc rgb '{}' title 'random', keyentry with points pt {} lc rgb '{}' title "
      "'crystal'",
      analysis::figure_style::kTriangle, kRandomColour, analysis::figure_style::kCircle, kCrystalColour);
}
std::string key_of_border() {
  return fmt::format("keyentry with lines {} title 'border of a region'", kBorder);
}

}  // namespace twincell::reproduce
