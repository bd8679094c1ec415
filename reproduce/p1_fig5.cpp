// Fortini & Huang 2015, Fig. 5: slip probability against 1/K_m, and the barriers of its Arrhenius law.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/figure_style.hpp"
#include "reproduce/p1_sweep.hpp"

namespace twincell::reproduce {

namespace {

constexpr double kBarrier = 7, kBarrierError = 1;           ///< random, and crystal in B
constexpr double kNucleation = 130, kNucleationError = 20;  ///< crystal in A2

constexpr int kLimitSymbol = analysis::figure_style::unfilled(analysis::figure_style::kDown);

/// Region of a crystal that slips, by what most of the runs at a drive strength do.
enum class Region {
  any,
  a2,  ///< without convection
  b,   ///< convecting
};

/// Points with slips. Rows of beads slip together, so the scatter is not binomial and all points have equal
/// weight.
std::vector<calibration::DataPoint> points_of(const StrengthSweep& sweep, Region region = Region::any) {
  std::vector<calibration::DataPoint> points;
  for (const SweepPoint& r : sweep.points) {
    const Region is = 2 * r.convecting >= r.runs ? Region::b : Region::a2;
    if (r.slips > 0 && (region == Region::any || region == is)) points.push_back({r.k_m(), r.p_s(), 0, 0});
  }
  return points;
}

/// The Arrhenius laws of the figure.
struct Barriers {
  std::optional<calibration::CurveFit> random, random_bent, a2, b;
};
Barriers barriers_of(const HeightSweeps& all) {
  Barriers fits;
  fits.random = fitted("arrhenius", points_of(all.random));
  fits.random_bent = fitted("arrhenius_break", points_of(all.random));
  if (!all.crystal.convection) return fits;
  fits.a2 = fitted("arrhenius", points_of(all.crystal, Region::a2));
  fits.b = fitted("arrhenius", points_of(all.crystal, Region::b));
  return fits;
}

Target barrier_target(const std::string& name, const std::optional<calibration::CurveFit>& fit,
                      double expected, double error, const char* none) {
  Target t{name, fmt::format("E_b = {:g} +- {:g}", expected, error), "", Verdict::absent, ""};
  if (!fit) {
    t.reason = none;
    return t;
  }
  const Estimate e = parameter(*fit, "E_b");
  t.measured = fmt::format("E_b = {}, {} points", e.text(), fit->n_used);
  t.verdict = judge(e, expected - error, expected + error);
  return t;
}

std::vector<Target> targets_of(const HeightSweeps& all, const Barriers& fits) {
  std::vector<Target> targets;
  constexpr const char* kTooFewPoints = "fewer than two points with slips";
  targets.push_back(
      barrier_target("(a) random, whole range", fits.random, kBarrier, kBarrierError, kTooFewPoints));
  if (targets.back().verdict == Verdict::fail)
    targets.back().reason = "the paper does not state its N_l, nor how far its window reaches";
  Target one{"(a) random: one line over the whole range, no break at the onset",
             "no break; barriers on either side within 2", "", Verdict::absent, ""};
  if (fits.random_bent) {
    const Estimate x = parameter(*fits.random_bent, "x_b");
    one.measured = fmt::format("best break at K_m {}, from E = {} to {}; by chance with p = {:.2g}", x.text(),
                               parameter(*fits.random_bent, "E_1").text(),
                               parameter(*fits.random_bent, "E_2").text(), fits.random_bent->p_nested);
    // Without a significant break, the barriers on either side decide how well a break is excluded.
    one.verdict = fits.random_bent->p_nested < 0.05
                      ? Verdict::fail
                      : agree(parameter(*fits.random_bent, "E_1"), parameter(*fits.random_bent, "E_2"),
                              2 * kBarrierError);
    if (one.verdict == Verdict::fail && !(fits.random_bent->p_nested < 0.05))
      one.verdict = Verdict::inconclusive;
  }
  targets.push_back(one);
  // Slips in region A1.
  Target zero{"(b) crystal: a region A1, where the bed bounces without a slip",
              "two drive strengths or more below the first slip", "", Verdict::absent, ""};
  if (all.crystal.first_slips) {
    double slips = 0, eligible = 0;
    std::size_t points = 0;
    for (const SweepPoint& r : all.crystal.points)
      if (r.bouncing > 0 && r.k_m() <= *all.crystal.first_slips->low) {
        slips += r.slips;
        eligible += r.eligible;
        ++points;
      }
    zero.measured = fmt::format(
        "{:.0f} of {:.0f} bead-periods on {} bouncing points, up to K_m {:.3g}; first "
        "slips at K_m {:.3g}",
        slips, eligible, points, *all.crystal.first_slips->low, *all.crystal.first_slips->high);
    // A single point could lack slips by chance.
    zero.verdict = points >= 2 ? Verdict::pass : Verdict::inconclusive;
    zero.reason =
        "A1 ends at the first slip by definition; Fig. 3 counts slips in a range of Gamma that is fixed";
    zero.not_counted = "counted in `p1-fig3`";
  } else if (!all.crystal.points.empty()) {
    for (const SweepPoint& r : all.crystal.points)
      if (r.bouncing > 0 && r.slips > 0) {
        zero.measured = fmt::format("{:.0f} slips already at K_m {:.3g}", r.slips, r.k_m());
        zero.verdict = Verdict::fail;
        break;
      }
  }
  targets.push_back(zero);
  // Barriers of the crystal, and their relation to each other and to that of random beds.
  constexpr const char* kRegion = "convection not found, or fewer than two points with slips in the region";
  targets.push_back(barrier_target("(b) crystal, A2", fits.a2, kNucleation, kNucleationError, kRegion));
  if (targets.back().verdict == Verdict::inconclusive)
    targets.back().reason = "few drive strengths lie in A2; docs/reproduce.md has a denser sweep at N_l = 20";
  targets.push_back(barrier_target("(b) crystal, B", fits.b, kBarrier, kBarrierError, kRegion));
  if (targets.back().verdict == Verdict::fail)
    targets.back().reason =
        "p_s nears 1 at strong drives, and the paper does not say how far its window reaches";
  Target order{"(b) crystal: the barrier of A2 is several times that of B", "3 times or more", "",
               Verdict::absent, ""};
  Target same{"barrier of B, crystal, is that of random beds", "within 2, the sum of the paper's errors", "",
              Verdict::absent, ""};
  if (fits.a2 && fits.b) {
    const Estimate a2 = parameter(*fits.a2, "E_b"), b = parameter(*fits.b, "E_b");
    Estimate three_b{3 * b.value, {}, {}};
    if (b.low) three_b.low = 3 * *b.low;
    if (b.high) three_b.high = 3 * *b.high;
    order.measured = fmt::format("{} and {}: {:.3g} times", a2.text(), b.text(), a2.value / b.value);
    order.verdict = above(a2, three_b);
  }
  if (fits.b && fits.random) {
    const Estimate b = parameter(*fits.b, "E_b"), random = parameter(*fits.random, "E_b");
    same.measured = fmt::format("crystal {}, random {}", b.text(), random.text());
    same.verdict = agree(b, random, 2 * kBarrierError);
  }
  targets.push_back(order);
  targets.push_back(same);
  return targets;
}

/// Clause of a gnuplot command that draws exp(c - e_b/K_m) against 1/K_m between two K_m.
std::string line_of(double c, double e_b, double from, double to, const std::string& look) {
  return fmt::format(", [{:.6g}:{:.6g}] exp({:.8g} - {:.8g}*x) with lines {} notitle", 1 / to, 1 / from, c,
                     e_b, look);
}

/// The fitted law, and the paper's barrier through the mean of the same points: the paper does not state its
/// prefactor.
std::string lines_of(const std::optional<calibration::CurveFit>& fit,
                     const std::vector<calibration::DataPoint>& points, double paper, double from,
                     double to) {
  if (!fit || points.empty()) return "";
  const Estimate e = parameter(*fit, "E_b");
  double mean_x = 0, mean_ln_y = 0;
  for (const calibration::DataPoint& p : points) {
    mean_x += 1 / p.x / static_cast<double>(points.size());
    mean_ln_y += std::log(p.y) / static_cast<double>(points.size());
  }
  return line_of(std::log(fit->at(1.0)) + e.value, e.value, from, to,
                 fmt::format("lw {} lc rgb '#333333'", analysis::figure_style::kCurve)) +
         line_of(mean_ln_y + paper * mean_x, paper, from, to, analysis::figure_style::kStated);
}

/// "E_b = 10.6 (paper 7)" at the right of the panel, in two lines, so that it is clear of the points.
std::string barrier_label(const char* of, const std::optional<calibration::CurveFit>& fit, double paper,
                          double line) {
  if (!fit) return "";
  return fmt::format(
      "set label '{0}E_b = {1:.3g}' at graph 0.97,{3:.3f} right\nset label '(paper {2:g})' at graph "
      "0.97,{4:.3f} right\n",
      of, parameter(*fit, "E_b").value, paper, 0.93 - 0.22 * line, 0.85 - 0.22 * line);
}

/// A panel of the figure: counted slips, upper limits where the bed bounces, borders of the regions,
/// Arrhenius lines. \param index of the panel; its two data blocks are appended to `data`
std::string panel_of(const StrengthSweep& l, int layers, const std::string& figure, std::size_t index,
                     const Barriers& fits, const analysis::figure_style::PlotAxis& p_s, std::string& data) {
  analysis::figure_style::PlotAxis inverse{.label = "1/K_m", .low = 0};
  std::string counted, none;
  const double floor = p_s.with_margin().low;
  // Crystals slip in a narrow range of 1/K_m. Of A1, as much is shown.
  constexpr double kShownOfA1 = 2;
  const double end = l.first_slips ? kShownOfA1 / *l.first_slips->low : 1e300;
  for (const SweepPoint& r : l.points) {
    if (!(r.eligible > 0) || 1 / r.k_m() > end) continue;
    if (r.slips > 0) {
      const Estimate e = r.slip_probability();
      counted += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g}\n", 1 / r.k_m(), e.value,
                             std::max(e.low.value_or(e.value), floor), e.high.value_or(e.value));
    }
    if (!(r.slips > 0) && r.bouncing > 0)
      none += fmt::format("{:.6g} {:.6g}\n", 1 / r.k_m(), r.upper_limit());
    if (r.slips > 0 || r.bouncing > 0) inverse.show(1 / r.k_m());
  }
  data += fmt::format(
      "# {0}, N_l = {1}: 1/K_m, p_s, low, high\n{2}\n\n# {0}, N_l = {1}, no slip: 1/K_m, 95 % upper limit of "
      "p_s\n{3}\n\n",
      l.start, layers, counted.empty() ? "? ? ? ?\n" : counted, none.empty() ? "? ?\n" : none);
  std::string plot = analysis::figure_style::axes(inverse, p_s) + "unset arrow\nunset label\n" +
                     analysis::figure_style::panel_title(static_cast<char>('a' + index), title_of(l, layers));
  std::string lines;
  const auto name = [&](const char* region, double from, double to) {
    plot +=
        fmt::format("set label '{}' at first {:.5g},graph 0.06 center\n", region, (1 / from + 1 / to) / 2);
  };
  const double last = l.points.empty() ? 30 : l.points.back().k_m(), first = 1.34;
  if (l.convection) {
    plot += border_of_region(1 / l.convection->value);
    name("B", l.convection->value, 1e3);
  }
  if (l.is_random()) {
    const auto points = points_of(l);
    lines = lines_of(fits.random, points, kBarrier, points.empty() ? first : points.front().x, last);
    plot += barrier_label("", fits.random, kBarrier, 0);
    if (l.convection) name("A", l.convection->value, first);
  } else if (l.convection) {
    const double onset = l.convection->value, slips = l.first_slips ? *l.first_slips->high : first;
    lines = lines_of(fits.a2, points_of(l, Region::a2), kNucleation, std::min(slips, onset), onset) +
            lines_of(fits.b, points_of(l, Region::b), kBarrier, onset, last);
    plot += barrier_label("A_2: ", fits.a2, kNucleation, 0) + barrier_label("B: ", fits.b, kBarrier, 1);
    if (l.first_slips && l.first_slips->value < onset) {
      plot += border_of_region(1 / l.first_slips->value);
      name("A_2", onset, l.first_slips->value);
      name("A_1", l.first_slips->value, std::max(first, 1 / end));
    }
  }
  std::string clauses = "NaN notitle";
  const auto points = [&](const std::string& block, std::size_t which, const char* drawn, int symbol) {
    if (!block.empty())
      clauses += fmt::format(", '{}.dat' index {} using {} pt {} lc rgb '{}' notitle", figure, which, drawn,
                             symbol, colour_of(l));
  };
  points(counted, 2 * index, "1:2:3:4 with yerrorbars", symbol_of(l));
  points(none, 2 * index + 1, "1:2 with points", kLimitSymbol);
  return plot + fmt::format("plot {}{}\n", clauses, lines);
}

Reproduction run(const Request& request) {
  const StrengthSweeps all = strength_sweeps(request);
  Reproduction r = reproduction_of(all, "Fortini & Huang 2015, Fig. 5: slip probability against 1/K_m");
  r.targets = targets_at_heights(all, slip_targets);
  r.figures = {slip_figure("p1-fig5", all)};
  return r;
}

}  // namespace

analysis::Figure slip_figure(const std::string& name, const StrengthSweeps& all) {
  const int rows = static_cast<int>(all.heights.size());
  analysis::Figure f{.name = name, .title = "Slip probability", .width = 720, .height = 60 + 370 * rows};
  const analysis::figure_style::Panels panels(all.heights.size(), 2, f.width, f.height, 2);
  f.plot = analysis::figure_style::Panels::begin();
  analysis::figure_style::PlotAxis p_s{.label = "p_s", .logarithmic = true};
  for (const HeightSweeps& height : all.heights)
    for (const StrengthSweep* l : {&height.random, &height.crystal})
      for (const SweepPoint& r : l->points)
        if (r.eligible > 0) p_s.show(r.slips > 0 ? r.p_s() : r.upper_limit());
  p_s.show(3);            // above the points, for the barriers
  p_s.show(p_s.low / 5);  // below them, for the names of the regions
  std::size_t index = 0;
  for (const HeightSweeps& height : all.heights) {
    const Barriers fits = barriers_of(height);
    for (const StrengthSweep* l : {&height.random, &height.crystal}) {
      f.plot += panels.panel(index) + panel_of(*l, height.layers, name, index, fits, p_s, f.data);
      ++index;
    }
  }
  f.plot += panels.end(
      {key_of_starts(),
       fmt::format("keyentry with points pt {} lc rgb '#333333' title 'no slip: limit'", kLimitSymbol),
       fmt::format("keyentry with lines lw {} lc rgb '#333333' title 'Arrhenius law'",
                   analysis::figure_style::kCurve),
       key_of_border(), analysis::figure_style::stated_line_entry("paper’s E_b")});
  f.caption =
      "Slip probability against 1/K_m from random beds (left) and crystals (right), counted over all runs, "
      "with 95 % intervals over the runs where there are several; open symbols: no slip in a bed that "
      "bounces, drawn at the 95 % limit, down to half of the K_m of the first slips. Lines: Arrhenius laws, "
      "all points alike; thick dashed: the paper's "
      "barriers through the mean of the same points, as the paper states no prefactor. Thin dashed: regions "
      "of Fig. 4. Form of Fortini & Huang 2015, Fig. 5.";
  return f;
}

std::vector<Target> slip_targets(const HeightSweeps& sweeps) {
  return targets_of(sweeps, barriers_of(sweeps));
}

Reproducible p1_fig5() {
  return {.name = "p1-fig5",
          .what = "slip probability against 1/K_m and its energy barriers, random and crystal starts",
          .run = run,
          .shared_runs = kStrengthSweepRuns,
          .judges_stored = true,
          .on_device = true,
          .runs_like = "p1-fig4"};
}

}  // namespace twincell::reproduce
