// Fortini & Huang 2015, Fig. 3: phase diagram in Gamma and bed height. Onsets of bouncing and convection,
// from random and crystalline starts, for each N_l.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <nlohmann/json.hpp>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/table.hpp"
#include "reproduce/is_arrested.hpp"
#include "reproduce/p1_scene.hpp"
#include "reproduce/reproduction.hpp"
#include "reproduce/user_points.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;
using sweep::Onset;

/// Extent of the study at a given budget: heights, runs and cycles. The physics does not depend on the
/// budget.
struct Size {
  double core_minutes;  ///< smallest budget for this size, core-minutes
  std::vector<int> layers;
  int bounce_cycles, convect_cycles, runs;
  double bounce_width, convect_width;
};

/// s_c is defined over N_f = 200 cycles, and at N_l = 20 half of the random beds need more than 60 cycles to
/// decide. A budget that is too small for 200 cycles at several heights therefore pays for one height. N_l =
/// 20 runs first, so that a slow machine still gives a partial result.
const std::array<Size, 7>& sizes() {
  static const std::array<Size, 7> all = {{
      {0, {20}, 30, 100, 30, 0.05, 0.4},
      {20, {20}, 30, 200, 40, 0.05, 0.3},
      {60, {10, 20}, 30, 200, 40, 0.05, 0.3},
      {240, {10, 20, 40}, 50, 200, 40, 0.04, 0.25},
      {1000, {10, 20, 40, 60}, 50, 200, 50, 0.03, 0.2},
      {2500, {10, 20, 40, 60, 80}, 50, 200, 50, 0.03, 0.2},
      {1e300, {10, 20, 40, 60, 80}, 100, 200, 60, 0.02, 0.15},
  }};
  return all;
}

const Size& size_for(const Request& request) {
  if (request.full) return sizes().back();
  const double core_minutes = request.minutes * request.threads;
  const Size* chosen = &sizes().front();
  for (const Size& size : sizes())
    if (core_minutes >= size.core_minutes) chosen = &size;
  return *chosen;
}

constexpr int kLayersOfA1 = 20;
constexpr double kOmega = 1;
constexpr double kConvectionKm = 3.3;  ///< the paper's onset of convection of random beds

P1Run run_of(int layers, bool random, int cycles) {
  return {layers, random ? "random" : "crystal_a", cycles};
}

/// Whether the analysis has the result "slips".
bool has_slips() {
  const auto names = analysis::result_names();
  return std::find(names.begin(), names.end(), "slips") != names.end();
}

/// One search of the figure.
struct Boundary {
  int layers;
  bool random, convecting;
  sweep::Plan plan = {};
  std::optional<sweep::Schedule> schedule = {};  ///< while the runs are computed
  std::optional<sweep::Plan> grid = {};          ///< runs over the whole range next to the search (grid_of)
  std::optional<sweep::Schedule> grid_schedule = {};  ///< while they are computed
  bool complete = false;
  std::vector<sweep::Trial> trials = {};  ///< of all runs
  std::vector<sweep::Trial> moving = {};  ///< the same; a bed that came to rest does not convect
  std::size_t at_rest = 0;  ///< runs with s_c > sigma whose bed had come to rest: it had rearranged once,
                            ///< which the paper's criterion does not distinguish from convection
  Onset onset_of_all = {}, onset_of_moving = {};

  [[nodiscard]] const Onset& onset() const { return onset_of_all; }
  [[nodiscard]] bool begun() const { return onset().n > 0; }
  [[nodiscard]] std::string start() const { return random ? "random" : "crystal"; }
  [[nodiscard]] std::string verdict() const { return convecting ? "convecting" : "bouncing"; }

  void add(double gamma, bool yes, bool moves) {
    trials.push_back({gamma, yes});
    moving.push_back({gamma, moves});
    at_rest += yes && !moves ? 1 : 0;
  }
  /// Enters a run. \param answer of its verdict
  void add(double gamma, bool answer, const std::string& result) {
    bool moves = false;
    if (answer) {
      const json found = json::parse(result)["results"].value("s_j", json::object()).value("value", json());
      std::vector<double> s_j;
      for (const json& x : found) s_j.push_back(x.is_number() ? x.get<double>() : std::nan(""));
      moves = !is_arrested(s_j);
    }
    add(gamma, answer, moves);
  }
  /// Enters the runs of the schedules, which are no longer needed.
  void read() {
    complete = schedule->all() && (!grid_schedule || grid_schedule->all());
    const sweep::Curve& curve = schedule->curves().front();
    for (std::size_t k = 0; k < curve.points.size(); ++k)
      if (const auto& result = curve.results[k])
        if (const auto answer = sweep::answer_of(*result)) add(*curve.points[k].at, *answer, *result);
    schedule.reset();
    if (!grid_schedule) return;
    for (const sweep::Curve& of_gamma : grid_schedule->curves())
      for (const auto& result : of_gamma.results) {
        if (!result) continue;
        const json s_c = json::parse(*result).value("results", json::object()).value("s_c", json::object());
        if (const json value = s_c.value("value", json()); value.is_number())
          add(std::stod(of_gamma.values.front()), value.get<double>() > analysis::kConvectionThreshold,
              *result);
      }
    grid_schedule.reset();
  }
  /// The onsets from the runs.
  void estimate() {
    const sweep::Search& search = *plan.search;
    onset_of_all = sweep::estimate_onset(trials, search.low, search.high, search.width);
    onset_of_moving = sweep::estimate_onset(moving, search.low, search.high, search.width);
  }
};

sweep::Plan plan_of(const Size& size, int layers, bool random, bool convecting, std::uint64_t seed) {
  // Ranges of TARGETS in Gamma: bouncing 1.0 to 1.5, convection 1.2 to 3 from random starts, 1.8 to 5 from
  // crystals.
  const double low = convecting ? (random ? 1.2 : 1.8) : 1.0, high = convecting ? (random ? 3.0 : 5.0) : 1.5;
  const int cycles = convecting ? size.convect_cycles : size.bounce_cycles;
  const std::string text = fmt::format(
      "seed = {}\nstop_early = {}\nresults = [\"s_b\", \"s_c\", \"phase\", \"s_j\"]\n{}\n[search]\nverdict = "
      "\"{}\"\nrange = [{}, {}]\nwidth = {}\nruns = {}\n",
      seed, convecting, p1_scene(run_of(layers, random, cycles)), convecting ? "convecting" : "bouncing", low,
      high, convecting ? size.convect_width : size.bounce_width, size.runs);
  return sweep::read_plan_text(text, fmt::format("p1-fig3, {} layers", layers));
}

/// Runs of random beds over the whole range of Gamma. A search puts its runs where the verdict seems to
/// change; of random beds, some convect far below and some do not far above, and a logistic law that knows
/// few of them comes out too steep. The seeds are not those of the search.
std::optional<sweep::Plan> grid_of(const Size& size, int layers, bool random, bool convecting,
                                   std::uint64_t seed) {
  constexpr double kSmallestBudget = 60;        // core-minutes
  constexpr std::array kOfGrid = {10, 20, 40};  // layers; the others take hours
  if (!random || !convecting || size.core_minutes < kSmallestBudget) return std::nullopt;
  if (std::find(kOfGrid.begin(), kOfGrid.end(), layers) == kOfGrid.end()) return std::nullopt;
  return sweep::read_plan_text(
      fmt::format("seed = {}\nresults = [\"s_c\", \"s_j\"]\n{}[axes]\ndrive.gamma = [1.45, 1.65, 1.85, "
                  "2.05, 2.25, 2.45, 2.65, 2.85]\nseeds = 4\n",
                  seed + 1, p1_scene(run_of(layers, random, size.convect_cycles))),
      fmt::format("p1-fig3, {} layers, grid", layers));
}

json as_json(const Boundary& b, int cycles) {
  json j = {{"layers", b.layers}, {"start", b.start()}, {"verdict", b.verdict()}};
  if (!b.begun()) return j;
  const Onset& o = b.onset();
  j["gamma"] = {{"value", number_or_null(o.value)},
                {"low", number_or_null(o.low)},
                {"high", number_or_null(o.high)},
                {"level", o.level}};
  const auto squared = [](const std::optional<double>& gamma) {
    return number_or_null(gamma ? std::optional(*gamma * *gamma) : std::nullopt);
  };
  j["k_m"] = {{"value", squared(o.value)}, {"low", squared(o.low)}, {"high", squared(o.high)}};
  j["runs"] = o.n;
  j["yes"] = o.yes;
  j["complete"] = b.complete;
  j["width"] = b.plan.search->width;
  j["cycles"] = cycles;
  j["text"] = o.text();
  for (std::size_t k = 0; k < b.trials.size(); ++k)
    j["trials"].push_back({b.trials[k].x, b.trials[k].yes, b.moving[k].yes});
  if (b.convecting) {
    const Onset& moving = b.onset_of_moving;
    j["at_rest"] = b.at_rest;
    j["moving"] = {{"value", number_or_null(moving.value)},
                   {"low", number_or_null(moving.low)},
                   {"high", number_or_null(moving.high)},
                   {"level", moving.level}};
  }
  return j;
}

/// Slips of crystals in region A1, summed over runs.
struct SlipCount {
  std::size_t runs = 0;
  double slips = 0, eligible = 0;
};

/// Runs of crystals in region A1.
struct Crystals {
  sweep::Plan plan;
  std::optional<sweep::Schedule> schedule;

  [[nodiscard]] SlipCount count() const {
    SlipCount all;
    for (const auto& curve : schedule->curves())
      for (const auto& result : curve.results) {
        if (!result) continue;
        const json r = json::parse(*result).value("results", json::object());
        const json slips = r.value("slips", json::object());
        if (!slips.value("value", json()).is_number()) continue;
        ++all.runs;
        all.slips += slips["value"].get<double>();
        all.eligible += slips.value("n", 0.0);
      }
    return all;
  }
};

std::optional<Crystals> crystals_of(const Size& size, std::uint64_t seed) {
  if (!has_slips()) return std::nullopt;
  Crystals c;
  c.plan = sweep::read_plan_text(fmt::format("seed = {}\nresults = [\"slips\", \"p_s\", \"s_b\", "
                                             "\"phase\"]\n{}\n[axes]\ndrive.gamma = [1.2, 1.5, 1.8, 2.1]\n",
                                             seed, p1_scene(run_of(kLayersOfA1, false, size.convect_cycles))),
                                 "p1-fig3, slips");
  return c;
}

const Boundary* find(const std::deque<Boundary>& all, int layers, bool random, bool convecting) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Boundary& b) {
    return b.layers == layers && b.random == random && b.convecting == convecting;
  });
  return found == all.end() || !found->begun() ? nullptr : &*found;
}

/// Onsets measured in an experiment at one height of the bed; NaN if not measured.
struct Filmed {
  double layers, bouncing, convection;
};

/// The experiment's points from a table with the columns N_l, bouncing and convection (Gamma), in the order
/// of the height.
std::vector<Filmed> filmed_in(const std::filesystem::path& file) {
  if (file.empty()) return {};
  const Table table = read_table(file);
  const auto& layers = own_column(table, "N_l");
  const auto& bouncing = own_column(table, "bouncing", {.empty = true});
  const auto& convection = own_column(table, "convection", {.empty = true});
  std::vector<Filmed> points;
  for (std::size_t i = 0; i < layers.size(); ++i) points.push_back({layers[i], bouncing[i], convection[i]});
  std::sort(points.begin(), points.end(),
            [](const Filmed& a, const Filmed& b) { return a.layers < b.layers; });
  return points;
}

/// Target that at N_l = 60 and 80 the onset of convection of random beds is below that of the experiment.
Target below_experiment(const std::deque<Boundary>& all, const std::vector<Filmed>& filmed) {
  Target t{"onset of convection, random, below the experiment at N_l = 60, 80", "below", "", Verdict::absent,
           ""};
  if (filmed.empty())
    t.reason = "the paper gives the experiment's numbers only as a drawing; --data takes yours";
  std::vector<Verdict> verdicts;
  for (const Filmed& point : filmed) {
    if (point.layers < 60 || !std::isfinite(point.convection)) continue;
    const Boundary* b = find(all, static_cast<int>(std::lround(point.layers)), true, true);
    if (b == nullptr) continue;
    const Onset& o = b->onset();
    t.measured += fmt::format("{}N_l = {}: {}; experiment {:.4g}", t.measured.empty() ? "" : ", ", b->layers,
                              o.text(), point.convection);
    verdicts.push_back(above(exact(point.convection), estimate_of(o)));
  }
  if (!filmed.empty() && verdicts.empty())
    t.reason = "no N_l from 60 on has a random bed here and a point in the data";
  t.verdict = all_of(verdicts);
  return t;
}

Target bouncing_target(const Size& size, const std::deque<Boundary>& all, int layers, bool random) {
  constexpr double kBounceLow = 1.10, kBounceHigh = 1.35;
  Target t{fmt::format("onset of bouncing, {}, N_l = {}", random ? "random" : "crystal", layers),
           fmt::format("Gamma {:.2f} to {:.2f}", kBounceLow, kBounceHigh), "", Verdict::absent, ""};
  if (const Boundary* b = find(all, layers, random, false)) {
    t.measured = b->onset().text();
    t.verdict = judge(estimate_of(b->onset()), kBounceLow, kBounceHigh);
    t.runs = fmt::format("{} runs, {} cycles", b->onset().n, size.bounce_cycles);
  }
  return t;
}

/// What the beds that came to rest do to the order of the onsets, which the paper's criterion does not
/// exclude.
std::string without_beds_at_rest(const Boundary& random, const Boundary& crystal) {
  const std::string had = fmt::format(
      "s_c above sigma as the paper has it; {} of the {} random beds that exceed it had rearranged once and "
      "come to rest",
      random.at_rest, random.onset().yes);
  if (random.at_rest + crystal.at_rest == 0) return had;
  return had + fmt::format(" (crystals: {} of {}); without them random {}, crystal {}, the order: {}",
                           crystal.at_rest, crystal.onset().yes, random.onset_of_moving.text(),
                           crystal.onset_of_moving.text(),
                           word_of(above(crystal.onset_of_moving, random.onset_of_moving)));
}

Target crystal_above_random(const Size& size, const std::deque<Boundary>& all, int layers) {
  Target t{fmt::format("onset of convection, N_l = {}", layers), "crystal above random", "", Verdict::absent,
           ""};
  const Boundary *random = find(all, layers, true, true), *crystal = find(all, layers, false, true);
  if (random != nullptr && crystal != nullptr) {
    t.measured = fmt::format(
        "crystal {}; random {}; the likelihood of this order is exp({:.3g}) times that of the "
        "opposite one",
        crystal->onset().text(), random->onset().text(),
        std::abs(evidence_above(crystal->onset(), random->onset())) / 2);
    t.verdict = above(crystal->onset(), random->onset());
    t.reason = without_beds_at_rest(*random, *crystal);
    if (random->onset().high && !random->onset().low)
      t.reason += fmt::format(
          "; at Gamma {:g}, where the search begins, some random beds exceed it already (docs/reproduce.md "
          "has "
          "one from Gamma 1 on)",
          random->plan.search->low);
    t.runs =
        fmt::format("{} and {} runs, {} cycles", crystal->onset().n, random->onset().n, size.convect_cycles);
    if (t.verdict == Verdict::inconclusive)
      t.reason +=
          fmt::format("{}exp({:.3g}) would decide", t.reason.empty() ? "" : "; ", sweep::kLikelihoodDrop / 2);
  }
  return t;
}

/// The paper does not state N_l of its Figs. 4 and 5. The best verdict is shown, of the heights at which the
/// slips of Fig. 5 are defined: lower beds have too few beads in bonds that can be counted. It is not in the
/// sum, as Fig. 4 judges the onset at the height that its other numbers are judged at.
Target onset_of_figs_4_and_5(const Size& size, const std::deque<Boundary>& all) {
  constexpr double kLow = kConvectionKm * 0.75, kHigh = kConvectionKm * 1.25;
  constexpr int kMinLayersWithSlips = 20;
  Target t{"onset of convection, random, at the N_l of Figs. 4, 5", "K_m 3.3 +- 25 %", "", Verdict::absent,
           fmt::format(
               "the paper does not state that N_l; this is the best of the heights from N_l = {} on, where "
               "p_s is defined",
               kMinLayersWithSlips)};
  t.not_counted = "counted in `p1-fig4`, at the height of its other numbers";
  for (const int layers : size.layers)
    if (const Boundary* b = find(all, layers, true, true)) {
      const Estimate onset = estimate_of(b->onset());
      const auto squared = [](double gamma) { return gamma * gamma; };
      const Estimate k_m{squared(onset.value), onset.low ? std::optional(squared(*onset.low)) : std::nullopt,
                         onset.high ? std::optional(squared(*onset.high)) : std::nullopt};
      const Verdict verdict = judge(k_m, kLow, kHigh);
      t.measured += fmt::format("{}N_l = {}: K_m {}: {}", t.measured.empty() ? "" : ", ", layers, k_m.text(),
                                word_of(verdict));
      t.runs += fmt::format("{}{}", t.runs.empty() ? "" : ", ", b->onset().n);
      if (layers >= kMinLayersWithSlips)
        t.verdict = t.verdict == Verdict::absent ? verdict : best_of(t.verdict, verdict);
    }
  if (!t.runs.empty()) t.runs += fmt::format(" runs, {} cycles", size.convect_cycles);
  return t;
}

Target bouncing_rises(const Size& size, const std::deque<Boundary>& all) {
  Target t{"onset of bouncing rises slightly with N_l", "rising", "", Verdict::absent, ""};
  if (size.layers.size() < 2) {
    t.reason = "one N_l only at this budget";
    return t;
  }
  std::vector<Verdict> verdicts;
  for (const bool random : {true, false}) {
    const Boundary* low = find(all, size.layers.front(), random, false);
    const Boundary* high = find(all, size.layers.back(), random, false);
    if (low == nullptr || high == nullptr) return t;
    verdicts.push_back(above(high->onset(), low->onset()));
    t.measured += fmt::format("{}{}: {} at N_l = {}, {} at {}, {}", t.measured.empty() ? "" : "; ",
                              random ? "random" : "crystal", low->onset().text(), low->layers,
                              high->onset().text(), high->layers, word_of(verdicts.back()));
  }
  t.verdict = all_of(verdicts);
  if (t.verdict == Verdict::inconclusive) t.reason = "the rise is smaller than what these runs can tell";
  if (verdicts[0] == Verdict::fail && verdicts[1] == Verdict::pass)
    t.reason = "that of crystals rises, that of random beds falls; the paper states it of both";
  return t;
}

Target no_slips_in_a1(const Size& size, const std::optional<SlipCount>& crystals) {
  Target t{fmt::format("slips of the crystal in A1, N_l = {}", kLayersOfA1), "exactly 0", "", Verdict::absent,
           ""};
  if (!crystals) {
    t.reason = "the analysis has no slip count";
  } else if (crystals->runs > 0) {
    t.measured =
        fmt::format("{:.0f} of {:.0f} bead-periods, Gamma 1.2 to 2.1", crystals->slips, crystals->eligible);
    t.runs = fmt::format("{} runs, {} cycles", crystals->runs, size.convect_cycles);
    t.verdict = judge(exact(crystals->slips), 0, 0);
  }
  return t;
}

std::vector<Target> targets_of(const Size& size, const std::deque<Boundary>& all,
                               const std::optional<SlipCount>& crystals, const std::vector<Filmed>& filmed) {
  std::vector<Target> targets;
  for (const int layers : size.layers)
    for (const bool random : {true, false}) targets.push_back(bouncing_target(size, all, layers, random));
  for (const int layers : size.layers) targets.push_back(crystal_above_random(size, all, layers));
  targets.push_back(onset_of_figs_4_and_5(size, all));
  targets.push_back(bouncing_rises(size, all));
  targets.push_back(no_slips_in_a1(size, crystals));
  targets.push_back(below_experiment(all, filmed));
  return targets;
}

/// Look of the onsets of one start and one verdict.
struct Style {
  bool random, convecting, moving;  ///< moving: the onset without beds that had come to rest
  int point;
  const char *colour, *title;
};
constexpr std::array<Style, 6> kStyles = {
    {{true, true, false, 9, analysis::colours::kGreen, "convection, random"},
     {false, true, false, 7, analysis::colours::kBlue, "convection, crystal"},
     {true, false, false, 8, analysis::colours::kGreen, "bouncing, random"},
     {false, false, false, 6, analysis::colours::kBlue, "bouncing, crystal"},
     {true, true, true, 11, analysis::colours::kGreen, "random, none at rest"},
     {false, true, true, 13, analysis::colours::kBlue, "crystal, none at rest"}}};

/// The figure so far: data blocks, the clauses of the plot command, and the ranges of the axes.
struct Drawing {
  analysis::Figure figure{
      .name = "p1-fig3", .title = "Onsets of bouncing and convection", .width = 640, .height = 520};
  std::string plot;
  int index = 0;  ///< number of the next data block
  analysis::figure_style::PlotAxis n_l{.label = "N_l σ"}, gamma{.label = "Γ = A ω^2/g"};
};

/// Onsets of the runs in one style, one data block of values and one of limits. Values with error bars if the
/// interval is closed, arrows for one-sided limits. Lines join values at consecutive heights and do not pass
/// over a limit. Random and crystal points are shifted slightly to the left and right of their N_l, so that
/// the bars do not overlap. Onsets without beds at rest stand further out, unconnected, at the heights where
/// there were such beds; elsewhere they are the same as with them.
void add_onsets(Drawing& d, const std::deque<Boundary>& all, const Style& style) {
  std::string values, limits;
  bool limit_before = false;
  for (const Boundary& b : all) {
    if (b.random != style.random || b.convecting != style.convecting || !b.begun()) continue;
    if (style.moving && b.at_rest == 0) continue;
    const Onset& o = style.moving ? b.onset_of_moving : b.onset();
    const double x = b.layers + (b.random ? -1 : 1) * (style.moving ? 1.5 : 0.5);
    d.n_l.show(x);
    for (const auto& end : {o.value, o.low, o.high})
      if (end) d.gamma.show(*end);
    const bool closed = o.value && o.low && o.high;
    // A blank line interrupts the line that gnuplot draws.
    if (closed && limit_before && !values.empty()) values += '\n';
    limit_before = !closed;
    if (closed)
      values += fmt::format("{} {} {} {}\n", x, *o.value, *o.low, *o.high);
    else if (o.low)
      limits += fmt::format("{} {} 0 0.25\n", x, *o.low);
    else if (o.high)
      limits += fmt::format("{} {} 0 -0.25\n", x, *o.high);
  }
  const auto add = [&](const std::string& block, const std::string& drawn, const std::string& title) {
    d.figure.data += fmt::format("# {}\n{}\n\n", style.title, block.empty() ? "NaN NaN NaN NaN\n" : block);
    d.plot += fmt::format("{}'{}.dat' index {} using 1:2:3:4 with {} lc rgb '{}' {}",
                          d.plot.empty() ? "" : ", ", d.figure.name, d.index++, drawn, style.colour, title);
  };
  if (style.moving && values.empty() && limits.empty()) return;
  add(values,
      fmt::format("{} lw {} ps {} pt {}", style.moving ? "yerrorbars" : "yerrorlines",
                  analysis::figure_style::kLine, style.moving ? 0.8 : 1.2, style.point),
      fmt::format("title '{}'", style.title));
  add(limits, "vectors head filled lw 1.5", "notitle");
}

/// Onsets of the experiment as one data block, if there are any.
void add_filmed(Drawing& d, const std::vector<Filmed>& filmed, double Filmed::*onset, int point,
                const char* title) {
  std::string block;
  for (const Filmed& p : filmed)
    if (std::isfinite(p.*onset)) {
      block += fmt::format("{} {}\n", p.layers, p.*onset);
      d.n_l.show(p.layers);
      d.gamma.show(p.*onset);
    }
  if (block.empty()) return;
  d.figure.data += fmt::format("# {}\n{}\n\n", title, block);
  d.plot +=
      fmt::format(", '{}.dat' index {} using 1:2 with linespoints lw 1 ps 1 pt {} lc rgb '{}' title '{}'",
                  d.figure.name, d.index++, point, analysis::colours::kBlack, title);
}

/// Onsets against the height of the bed, with K_m on the right.
analysis::Figure figure_of(const std::deque<Boundary>& all, const std::vector<Filmed>& filmed) {
  Drawing d;
  d.gamma.show(1);
  for (const Style& style : kStyles) add_onsets(d, all, style);
  add_filmed(d, filmed, &Filmed::convection, 5, "convection, experiment");
  add_filmed(d, filmed, &Filmed::bouncing, 4, "bouncing, experiment");
  d.plot += ", " + analysis::figure_style::stated_line_entry("paper: K_m = 3.3");
  // K_m = Gamma^2 at omega = 1: the ticks of K_m are at Gamma = sqrt(K_m).
  std::vector<std::string> ticks;
  for (const double k_m : {1.0, 2.0, 4.0, 6.0, 9.0, 12.0, 16.0, 20.0, 25.0})
    ticks.push_back(fmt::format("'{:g}' {:.6f}", k_m, std::sqrt(k_m) / kOmega));
  d.figure.plot = fmt::format(
      "{}set link y2\nset y2label 'K_m = A^2 ω^2/(σ g)'\nset ytics nomirror\nset y2tics ({})\nset key "
      "maxcols 2\n"
      "{}plot {}\n",
      analysis::figure_style::axes(d.n_l, d.gamma), fmt::join(ticks, ", "),
      analysis::figure_style::stated_y(std::sqrt(kConvectionKm) / kOmega), d.plot);
  d.figure.caption =
      "Onset of bouncing (open) and of convection (filled) against the height of the bed, from random starts "
      "(triangles) and from crystals (circles), drawn a little to the left and to the right, with 95 % "
      "intervals; arrows are one-sided limits. Small symbols further out (none at rest): the onset of "
      "convection without beds that had rearranged once and come to rest, where there were any.";
  d.figure.caption += filmed.empty()
                          ? " The paper's experiment is a drawing without numbers; --data draws yours as "
                            "connected squares."
                          : " Connected squares: the experiment of --data.";
  d.figure.caption +=
      " Dashed: the paper's onset of convection of random beds, at an N_l that it does not state. Form of "
      "Fortini & Huang 2015, Fig. 3.";
  return d.figure;
}

std::vector<std::string> cheaper_of(const Size& size, const std::deque<Boundary>& all) {
  std::vector<std::string> s;
  s.push_back(p1_cheaper_steps());
  std::vector<int> left_out;
  for (const int layers : sizes().back().layers)
    if (std::find(size.layers.begin(), size.layers.end(), layers) == size.layers.end())
      left_out.push_back(layers);
  if (!left_out.empty()) s.push_back(fmt::format("N_l = {} left out", fmt::join(left_out, ", ")));
  if (size.convect_cycles < 200)
    s.push_back(
        fmt::format("s_c over N_f = {} cycles, where 200 are the definition: beds that begin to convect "
                    "later are missed, so onsets come out high",
                    size.convect_cycles));
  s.push_back(fmt::format("s_b over {} cycles, where 200 are the definition", size.bounce_cycles));
  s.emplace_back("runs for convection end when their verdict is settled (docs/sweeps.md)");
  std::size_t runs = 0;
  for (const Boundary& b : all) runs += b.begun() ? b.onset().n : 0;
  s.push_back(
      fmt::format("{} runs in all: at most {} for an onset, placed where it may be, and for convection from "
                  "random starts at N_l = 10, 20 and 40 a grid over the whole range",
                  runs, size.runs));
  return s;
}

/// The runs of the figure: its searches, and the slips of its crystals.
struct Runs {
  std::deque<Boundary> boundaries;  // schedules refer to their plans, so elements must not move
  std::optional<SlipCount> crystals;
  bool complete = true;
};

Boundary& add_boundary(Runs& runs, const Size& size, int layers, bool random, bool convecting,
                       std::uint64_t seed) {
  Boundary& b = runs.boundaries.emplace_back();
  b.layers = layers;
  b.random = random;
  b.convecting = convecting;
  b.plan = plan_of(size, layers, random, convecting, seed);
  b.grid = grid_of(size, layers, random, convecting, seed);
  return b;
}

Runs simulated(const Request& request, const Size& size) {
  Runs runs;
  const sweep::Store store(request.folder);
  for (const int layers : size.layers)
    for (const bool convecting : {true, false})
      for (const bool random : {true, false}) {
        Boundary& b = add_boundary(runs, size, layers, random, convecting, request.seed);
        b.schedule.emplace(b.plan, store);
        if (b.grid) b.grid_schedule.emplace(*b.grid, store);
      }
  std::optional<Crystals> crystals = crystals_of(size, request.seed);
  if (crystals) crystals->schedule.emplace(crystals->plan, store);
  std::vector<sweep::Schedule*> all;
  if (crystals) all.push_back(&*crystals->schedule);
  for (Boundary& b : runs.boundaries) {
    all.push_back(&*b.schedule);
    if (b.grid_schedule) all.push_back(&*b.grid_schedule);
  }
  announce(all, request.farm(), *request.watch);
  // Run the height that most targets use first, so that a lack of time affects the least important runs.
  for (const bool first : {true, false}) {
    std::vector<sweep::Schedule*> schedules;
    if (first && crystals) schedules.push_back(&*crystals->schedule);
    for (Boundary& b : runs.boundaries)
      if ((b.layers == kLayersOfA1) == first) {
        schedules.push_back(&*b.schedule);
        if (b.grid_schedule) schedules.push_back(&*b.grid_schedule);
      }
    runs.complete = run_here(schedules, store, request.farm(), *request.watch) && runs.complete;
  }
  for (Boundary& b : runs.boundaries) b.read();
  if (crystals) runs.crystals = crystals->count();
  return runs;
}

/// The runs of a document that this figure wrote. \param size its heights become those of the document
Runs stored_runs(const Request& request, Size& size) {
  Runs runs;
  size.layers.clear();
  for (const json& j : json::parse(request.stored)) {
    if (j.contains("slips")) {
      runs.crystals = SlipCount{j.at("runs").get<std::size_t>(), j.at("slips").get<double>(),
                                j.at("bead_periods").get<double>()};
      continue;
    }
    const int layers = j.at("layers").get<int>();
    if (std::find(size.layers.begin(), size.layers.end(), layers) == size.layers.end())
      size.layers.push_back(layers);
    if (j.contains("runs") && !j.contains("trials"))
      throw ConfigError({.file = {}, .key = "stored"},
                        "names a document of an earlier version, which does not hold the single runs.");
    const bool convecting = j.at("verdict") == "convecting";
    if (j.contains("trials")) {
      (convecting ? size.convect_cycles : size.bounce_cycles) = j.at("cycles").get<int>();
      (convecting ? size.convect_width : size.bounce_width) = j.at("width").get<double>();
    }
    Boundary& b = add_boundary(runs, size, layers, j.at("start") == "random", convecting, request.seed);
    b.complete = j.value("complete", false);
    for (const json& t : j.value("trials", json::array()))
      b.add(t.at(0).get<double>(), t.at(1).get<bool>(), t.at(2).get<bool>());
  }
  return runs;
}

Reproduction run(const Request& request) {
  if (request.window)
    throw ConfigError({.file = {}, .key = "window"}, "has no effect on p1-fig3, which has no W.");
  const std::vector<Filmed> filmed = filmed_in(request.data);
  Size size = size_for(request);
  Runs runs = request.stored.empty() ? simulated(request, size) : stored_runs(request, size);
  std::deque<Boundary>& boundaries = runs.boundaries;
  for (Boundary& b : boundaries) b.estimate();
  Reproduction r;
  r.title = "Fortini & Huang 2015, Fig. 3: onsets of bouncing and convection";
  r.complete = runs.complete;
  r.targets = targets_of(size, boundaries, runs.crystals, filmed);
  r.cheaper = cheaper_of(size, boundaries);
  r.conditions = p1_conditions(run_of(kLayersOfA1, false, size.convect_cycles));
  r.conditions.push_back(fmt::format("seeds of all runs drawn from the master seed {}", request.seed));
  json measured = json::array();
  for (const Boundary& b : boundaries) {
    measured.push_back(as_json(b, b.convecting ? size.convect_cycles : size.bounce_cycles));
    r.table +=
        fmt::format("  N_l = {:<3} {:<11} {:<8} {}{}", b.layers, b.verdict(), b.start(),
                    b.begun() ? "Gamma " + b.onset().text() : "not begun", b.complete ? "" : " (unfinished)");
    if (b.convecting && b.at_rest > 0)
      r.table += fmt::format("; at rest {}, moving from {}", b.at_rest, b.onset_of_moving.text());
    r.table += '\n';
  }
  r.table +=
      "  at rest: of the runs with s_c > sigma those whose s_j changed by less than 0.1 sigma in the second "
      "half of\n  their cycles: they had rearranged and came to rest; moving: the onset without them. Runs "
      "end early, so that\n  one that rearranges slowly counts as moving\n";
  if (runs.crystals)
    measured.push_back({{"layers", kLayersOfA1},
                        {"runs", runs.crystals->runs},
                        {"slips", runs.crystals->slips},
                        {"bead_periods", runs.crystals->eligible}});
  r.runs = fmt::format("{} cycles for s_b, {} for s_c", size.bounce_cycles, size.convect_cycles);
  r.measured = json_text(measured);
  r.figures = {figure_of(boundaries, filmed)};
  return r;
}

}  // namespace

Reproducible p1_fig3() {
  return {.name = "p1-fig3",
          .what = "phase diagram: onsets of bouncing and convection against N_l, random and crystal starts",
          .run = run,
          .takes_data = true,
          .judges_stored = true,
          .on_device = true,
          .time_share = 8};
}

}  // namespace twincell::reproduce
