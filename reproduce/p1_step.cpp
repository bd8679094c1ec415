// Effect of the time step on the physics of Fortini & Huang 2015: T_g*, p_s, s_b and s_c of its beds against
// the steps per contact, for Verlet, whose friction is of first order, and for the split integrator, whose
// friction is of second order.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/json_text.hpp"
#include "reproduce/p1_scene.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

constexpr int kLayers = 20;
constexpr int kPaperCycles = 200;
const std::vector<std::string> kStarts = {"crystal_a", "random"};
const std::vector<double> kGammas = {1.5, 2.0, 2.5, 3.0};
const std::vector<std::string> kIntegrators = {"verlet", "split"};
constexpr const char *kAliasing = "T_g_aliasing", *kEligible = "bead_cycles";
constexpr double kUsual = 50;  ///< n of the paper, a common choice with Verlet

constexpr double kTolerance = 0.02, kFloor = 0.01;

struct Quantity {
  const char* name;   ///< result of the analysis
  const char* label;  ///< gnuplot label
  bool relative;      ///< drawn relative to the value at the shortest split step

  /// Difference that counts as none. p_s and s_c can be 0, so they also have an absolute tolerance.
  [[nodiscard]] double tolerance_of(double value) const {
    return relative ? kTolerance * value : std::max(kTolerance * value, kFloor);
  }
};
constexpr std::array<Quantity, 4> kQuantities = {{{"T_g", "T_g^{*}/converged", true},
                                                  {"p_s", "p_s", false},
                                                  {"s_b", "s_b/converged", true},
                                                  {"s_c", "s_c/σ", false}}};

/// Extent of the study at a given budget.
struct Size {
  double core_minutes;
  int cycles, seeds;
  std::vector<double> verlet, split;
  [[nodiscard]] const std::vector<double>& steps(const std::string& integrator) const {
    return integrator == "verlet" ? verlet : split;
  }
};
const Size& size_for(const Request& request) {
  static const std::vector<Size> all = {
      {0, 5, 2, {12.5}, {6.37}},
      {10, 20, 2, {12.5, 50}, {6.37, 25}},
      {60, 50, 4, {12.5, 25, 50, 100}, {6.37, 25}},
      {160, 50, 8, {12.5, 25, 50, 100, 200}, {6.37, 12.5, 25}},
      {1e300, kPaperCycles, 16, {12.5, 25, 50, 100, 200, 400}, {6.37, 12.5, 25, 50}}};
  if (request.full) return all.back();
  const Size* chosen = &all.front();
  for (const Size& size : all)
    if (request.minutes * request.threads >= size.core_minutes) chosen = &size;
  return *chosen;
}

sweep::Plan plan_of(const Size& size, const std::string& integrator, std::uint64_t seed) {
  return sweep::read_plan_text(
      fmt::format("seed = {}\nresults = [\"s_b\", \"s_c\", \"p_s\", \"slips\", \"T_g\", \"T_g_aliasing\"]\n"
                  "[scene]\npreset = \"fortini-huang-2015\"\nbeads.layers = {}\nstart.perturbation = 1e-9\n"
                  "time.integrator = \"{}\"\ntime.discard = 10\ntime.cycles = {}\n"
                  "[axes]\nstart.kind = [\"{}\"]\ndrive.gamma = [{:.1f}]\ntime.steps_per_contact = "
                  "[{}]\nseeds = {}\n",
                  seed, kLayers, integrator, size.cycles, fmt::join(kStarts, "\", \""),
                  fmt::join(kGammas, ", "), fmt::join(size.steps(integrator), ", "), size.seeds),
      "the step's physics, " + integrator);
}

/// Identifies a quantity of a bed at one time step; its values are over the seeds.
struct Place {
  std::string quantity, start, integrator;
  double gamma = 0, steps = 0;
  auto operator<=>(const Place&) const = default;
};
using Values = std::map<Place, std::vector<double>>;

void collect(const std::string& integrator, const sweep::Schedule& schedule, Values& values) {
  for (const sweep::Curve& curve : schedule.curves())
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
      if (!curve.results[k]) continue;
      const json results = json::parse(*curve.results[k]).value("results", json::object());
      const auto axis = [&](const char* key) {
        const auto& axes = schedule.plan().axes;
        const auto at = std::find_if(axes.begin(), axes.end(), [&](const auto& a) { return a.key == key; });
        std::string value = curve.values[static_cast<std::size_t>(at - axes.begin())];
        std::erase_if(value, [](char c) { return c == '\'' || c == '"'; });  // remove TOML's quotes
        return value;
      };
      const auto file_under = [&](const char* name, double value) {
        values[{name, axis("start.kind"), integrator, std::stod(axis("drive.gamma")),
                std::stod(axis("time.steps_per_contact"))}]
            .push_back(value);
      };
      if (results.contains("slips")) file_under(kEligible, results["slips"].value("n", 0.0));
      for (const char* name : {"T_g", "p_s", "s_b", "s_c", kAliasing}) {
        const json r = results.value(name, json::object());
        if (!r.contains("value") || !r["value"].is_number()) continue;
        file_under(name, r["value"].get<double>());
      }
    }
}

std::optional<Estimate> estimate(const Values& values, const Place& place) {
  const auto at = values.find(place);
  if (at == values.end()) return std::nullopt;
  const std::vector<double>& runs = at->second;
  Estimate e;
  for (const double v : runs) e.value += v / static_cast<double>(runs.size());
  if (const auto interval = analysis::mean_interval(runs, "runs")) {
    e.low = place.quantity == kAliasing ? interval->low : std::max(0.0, interval->low);
    e.high = interval->high;
  }
  // If no run has a slip, the number of bead-cycles gives an upper limit.
  const auto trials = values.find({kEligible, place.start, place.integrator, place.gamma, place.steps});
  if (place.quantity == "p_s" && e.value == 0 && trials != values.end()) {
    double all = 0;
    for (const double n : trials->second) all += n;
    if (all > 0) {
      const analysis::Interval none = analysis::binomial_interval(0, all, "bead-cycles");
      e.low = none.low;
      e.high = none.high;
    }
  }
  return e;
}

const char* words_of(const std::string& start) {
  return start == "random" ? "random" : "crystal";
}

std::vector<Target> targets_of(const Values& values, const Size& size) {
  const double finest = size.split.back();
  const double coarse = std::find(size.verlet.begin(), size.verlet.end(), kUsual) != size.verlet.end()
                            ? kUsual
                            : size.verlet.back();
  std::vector<Target> targets;
  for (const auto& [integrator, n] :
       {std::pair<std::string, double>{"verlet", coarse}, {"split", size.split.front()}}) {
    if (integrator == "split" && size.split.size() == 1) continue;
    for (const Quantity& q : kQuantities)
      for (const std::string& start : kStarts) {
        Target t{fmt::format("{} of {} beds does not depend on the step: {}, n = {:g}", q.name,
                             words_of(start), integrator, n),
                 fmt::format("that of split, n = {:g}, within {:g} %{}", finest, 100 * kTolerance,
                             q.relative ? "" : fmt::format(" or {:g}", kFloor)),
                 "", Verdict::absent, ""};
        std::vector<Verdict> verdicts;
        for (const double gamma : kGammas) {
          const auto here = estimate(values, {q.name, start, integrator, gamma, n}),
                     there = estimate(values, {q.name, start, "split", gamma, finest});
          if (!here || !there) continue;
          verdicts.push_back(agree(*here, *there, q.tolerance_of(there->value)));
          t.measured += fmt::format("{}Gamma {:g}: {} against {}", t.measured.empty() ? "" : "; ", gamma,
                                    here->text(), there->text());
        }
        t.verdict = all_of(verdicts);
        if (verdicts.empty()) t.reason = "no run is done";
        targets.push_back(t);
      }
  }
  return targets;
}

std::string table_of(const Values& values, const Size& size) {
  std::string text;
  for (const std::string& start : kStarts)
    for (const double gamma : kGammas) {
      text += fmt::format("  {}, Gamma = {:g}\n  {:>8} {:>6} {:>26} {:>26} {:>26} {:>26} {:>10}\n",
                          words_of(start), gamma, "", "n", "T_g*", "p_s", "s_b", "s_c", "aliasing");
      for (const std::string& integrator : kIntegrators)
        for (const double n : size.steps(integrator)) {
          text += fmt::format("  {:>8} {:6g}", integrator, n);
          for (const Quantity& q : kQuantities) {
            const auto e = estimate(values, {q.name, start, integrator, gamma, n});
            text += fmt::format(" {:>26}", e ? e->text() : "-");
          }
          const auto aliasing = estimate(values, {kAliasing, start, integrator, gamma, n});
          text += fmt::format(" {:>10}\n", aliasing ? fmt::format("{:+.1f} %", 100 * aliasing->value) : "-");
        }
    }
  return text;
}

std::string json_of(const Values& values) {
  json all = json::array();
  for (const auto& [place, runs] : values) {
    const auto e = estimate(values, place);
    const auto number = [](const std::optional<double>& v) { return v ? json(*v) : json(nullptr); };
    all.push_back({{"quantity", place.quantity},
                   {"start", place.start},
                   {"integrator", place.integrator},
                   {"gamma", place.gamma},
                   {"steps_per_contact", place.steps},
                   {"value", e->value},
                   {"low", number(e->low)},
                   {"high", number(e->high)},
                   {"runs", runs}});
  }
  return json_text(all);
}

constexpr int kVerlet = analysis::figure_style::kCircle,
              kSplit = analysis::figure_style::unfilled(analysis::figure_style::kSquare);
constexpr const char* kStepTics = "set xtics (6.37, 12.5, 25, 50, 100, 200, 400)\n";

/// Curves over n: Verlet with filled symbols and solid lines, split with open symbols and dashed lines, one
/// colour for each Gamma.
analysis::Figure figure_of(const Values& values, const Size& size) {
  analysis::Figure f{
      .name = "p1-step", .title = "What the step does to the physics", .width = 720, .height = 1160};
  const double finest = size.split.back();
  const analysis::figure_style::Panels panels(kQuantities.size(), kStarts.size(), f.width, f.height, 2);
  f.plot = analysis::figure_style::Panels::begin();
  analysis::figure_style::PlotAxis steps{.label = "steps per contact n", .logarithmic = true};
  for (const std::string& integrator : kIntegrators)
    for (const double n : size.steps(integrator)) steps.show(n);
  int block = 0;
  std::size_t panel = 0;
  for (const Quantity& q : kQuantities)
    for (const std::string& start : kStarts) {
      analysis::figure_style::PlotAxis value{.label = q.label};
      if (!q.relative) value.show(0);
      std::vector<std::string> curves;
      for (std::size_t g = 0; g < kGammas.size(); ++g)
        for (const std::string& integrator : kIntegrators) {
          const auto converged = estimate(values, {q.name, start, "split", kGammas[g], finest});
          const double unit = q.relative && converged && converged->value > 0 ? converged->value : 1;
          std::string points;
          for (const double n : size.steps(integrator))
            if (const auto e = estimate(values, {q.name, start, integrator, kGammas[g], n}))
            // Shifted slightly, so that error bars do not overlap.
            {
              const double low = e->low.value_or(e->value) / unit, high = e->high.value_or(e->value) / unit;
              for (const double v : {e->value / unit, low, high}) value.show(v);
              points +=
                  fmt::format("{:.5g} {:.6g} {:.6g} {:.6g}\n",
                              n * (1 + 0.04 * (static_cast<double>(g) - 1.5)), e->value / unit, low, high);
            }
          if (points.empty()) continue;
          f.data += fmt::format("# {}, {}, Gamma = {:g}, {}: n, value, low, high\n{}\n\n", words_of(start),
                                q.name, kGammas[g], integrator, points);
          const bool verlet = integrator == "verlet";
          curves.push_back(fmt::format(
              "'{}.dat' index {} using 1:2:3:4 with yerrorlines pt {} ps 0.7 lw {} dt {} lc rgb '{}' notitle",
              f.name, block++, verlet ? kVerlet : kSplit, analysis::figure_style::kLine, verlet ? 1 : 2,
              analysis::colours::kCurves[g]));
        }
      if (curves.empty()) curves.emplace_back("NaN notitle");
      f.plot += panels.panel(panel) + analysis::figure_style::axes(steps, value) + kStepTics +
                analysis::figure_style::panel_title(static_cast<char>('a' + panel), words_of(start)) +
                fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
      ++panel;
    }
  std::vector<std::string> key;
  for (std::size_t g = 0; g < kGammas.size(); ++g)
    key.push_back(fmt::format("keyentry with lines lw {} lc rgb '{}' title 'Γ = {:g}'",
                              analysis::figure_style::kCurve, analysis::colours::kCurves[g], kGammas[g]));
  key.push_back(fmt::format("keyentry with linespoints pt {} lc rgb '#333333' title 'Verlet'", kVerlet));
  key.push_back(fmt::format("keyentry with linespoints pt {} dt 2 lc rgb '#333333' title 'split'", kSplit));
  f.plot += panels.end(key);
  f.caption = fmt::format(
      "Granular temperature, slip probability, s_b and s_c of beds of N_l = {} against the steps per contact "
      "n. Filled circles: Verlet, whose friction is of first order in the step. Open squares: split, of "
      "second order. Bars: 95 % over {} runs. T_g* and s_b are over their values for split at n = {:g}.",
      kLayers, size.seeds, finest);
  return f;
}

/// The values of a document that json_of() wrote. \param size its steps and seeds become those of the
/// document
Values stored_values(const std::string& stored, Size& size) {
  Values values;
  size.verlet.clear();
  size.split.clear();
  size.seeds = 0;
  for (const json& j : json::parse(stored)) {
    const Place place{j.at("quantity").get<std::string>(), j.at("start").get<std::string>(),
                      j.at("integrator").get<std::string>(), j.at("gamma").get<double>(),
                      j.at("steps_per_contact").get<double>()};
    std::vector<double>& runs = values[place];
    for (const json& run : j.at("runs"))
      if (run.is_number()) runs.push_back(run.get<double>());
    size.seeds = std::max(size.seeds, static_cast<int>(runs.size()));
    std::vector<double>& steps = place.integrator == "verlet" ? size.verlet : size.split;
    if (std::find(steps.begin(), steps.end(), place.steps) == steps.end()) steps.push_back(place.steps);
  }
  for (auto* steps : {&size.verlet, &size.split}) std::sort(steps->begin(), steps->end());
  return values;
}

/// Runs the schedules. \param complete becomes whether all points are done
Values simulated_values(const Request& request, const Size& size, bool& complete) {
  const sweep::Store store(request.folder);
  std::vector<sweep::Plan> plans;
  for (const std::string& integrator : kIntegrators) plans.push_back(plan_of(size, integrator, request.seed));
  std::vector<sweep::Schedule> schedules;
  for (const sweep::Plan& plan : plans) schedules.emplace_back(plan, store);
  std::vector<sweep::Schedule*> open;
  for (sweep::Schedule& s : schedules) open.push_back(&s);
  announce(open, request.farm(), *request.watch);
  complete = run_here(open, store, request.farm(), *request.watch);
  Values values;
  for (std::size_t k = 0; k < schedules.size(); ++k) collect(kIntegrators[k], schedules[k], values);
  return values;
}

Reproduction run(const Request& request) {
  Size size = size_for(request);
  Reproduction r;
  r.title = "What the time step does to the physics of Fortini & Huang 2015";
  r.complete = true;
  const Values values = request.stored.empty() ? simulated_values(request, size, r.complete)
                                               : stored_values(request.stored, size);
  r.runs = fmt::format("{} runs a point", size.seeds) +
           (request.stored.empty() ? fmt::format(", {} cycles", size.cycles) : "");
  r.targets = targets_of(values, size);
  r.table = table_of(values, size);
  r.measured = json_of(values);
  r.figures = {figure_of(values, size)};
  r.conditions = p1_contact_conditions();
  r.conditions.push_back(
      fmt::format("N_l = {}, crystals and random beds, both perturbed by 1e-9 sigma; 10 cycles discarded, {} "
                  "counted; {} runs of each, seeds drawn from the master seed {}",
                  kLayers, size.cycles, size.seeds, request.seed));
  r.conditions.emplace_back(
      "T_g* is a time average, from 400 samples a cycle; aliasing is what 20 phases would add");
  if (size.cycles < kPaperCycles)
    r.cheaper.push_back(
        fmt::format("{} cycles, where the paper defines s_c by {}", size.cycles, kPaperCycles));
  if (size.seeds < 8)
    r.cheaper.push_back(fmt::format("{} seeds: random beds differ by more than the step does", size.seeds));
  return r;
}

}  // namespace

Reproducible p1_step() {
  return {.name = "p1-step",
          .what = "effect of the time step on T_g, p_s, s_b and s_c",
          .run = run,
          .judges_stored = true,
          .on_device = true,
          .time_share = 2,
          .judges_again = true};
}

}  // namespace twincell::reproduce
