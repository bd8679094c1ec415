// Fortini & Huang 2015, Fig. 4: granular temperature against the strength of the drive.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/figure_style.hpp"
#include "reproduce/p1_sweep.hpp"

namespace twincell::reproduce {

namespace {

/// Points whose bed leaves the plate. At weaker drives T_g only measures vibrations at contacts.
std::vector<calibration::DataPoint> points_of(const StrengthSweep& sweep, double above = 0,
                                              double below = 1e300) {
  std::vector<calibration::DataPoint> points;
  for (const SweepPoint& r : sweep.points)
    if (r.bouncing > 0 && r.k_m() >= above && r.k_m() <= below)
      points.push_back({r.k_m(), r.mean_temperature().value, 0, 0});
  return points;
}

constexpr double kBreak = 3.3, kBreakError = 0.8;  ///< K_m of the paper's change of slope

constexpr std::size_t kRunsForScatter = 3;  ///< runs from which the interval covers the scatter between beds

/// Target that T_g* rises over all points: decades of the rise, and the points where T_g* falls.
Target rise_of(const StrengthSweep& sweep) {
  Target t{fmt::format("{}: T_g* rises monotonically, over many decades",
                       sweep.is_random() ? "(a) random" : "(b) crystal"),
           "from every point to the next, 3 decades or more", "", Verdict::absent, ""};
  if (sweep.points.size() < 3) return t;
  std::vector<Verdict> rises;
  std::string falls;
  for (std::size_t i = 1; i < sweep.points.size(); ++i) {
    const SweepPoint &below = sweep.points[i - 1], &point = sweep.points[i];
    const Estimate from = below.mean_temperature(), to = point.mean_temperature();
    rises.push_back(above(to, from));
    if (to.value <= from.value)
      falls += fmt::format("{}from {} at K_m {:.3g} to {} at {:.3g}", falls.empty() ? "" : ", ", from.text(),
                           below.k_m(), to.text(), point.k_m());
  }
  const double decades = std::log10(sweep.points.back().mean_temperature().value /
                                    sweep.points.front().mean_temperature().value);
  t.measured =
      fmt::format("{:.1f} decades from K_m {:.2g} to {:.3g}; {}", decades, sweep.points.front().k_m(),
                  sweep.points.back().k_m(), falls.empty() ? "never falls" : "falls " + falls);
  rises.push_back(holds(decades >= 3));
  t.verdict = all_of(rises);
  if (t.verdict == Verdict::inconclusive)
    t.reason = fmt::format("{} of {} steps lie within the intervals of their points",
                           std::count(rises.begin(), rises.end(), Verdict::inconclusive), rises.size() - 1);
  if (t.verdict != Verdict::fail || falls.empty()) return t;
  if (sweep.is_random() && sweep.points.front().runs < kRunsForScatter) {
    t.verdict = Verdict::inconclusive;
    t.reason = "neighbouring points are different beds, and beds differ by more than the interval of one run";
  } else {
    t.reason = "above Gamma = 4 a rigid inelastic bed, too, lands where it meets the plate more softly";
  }
  return t;
}

/// Slope of ln T_g* against ln K_m in a region of the crystal.
std::optional<Estimate> slope_of(const StrengthSweep& sweep, double above, double below) {
  const auto points = points_of(sweep, above, below);
  if (points.size() < 3) return std::nullopt;
  const auto fit = fitted("power", points);
  return fit ? std::optional(parameter(*fit, "alpha")) : std::nullopt;
}

/// Two power laws that meet, over a range of K_m.
std::optional<calibration::CurveFit> bend_of(const StrengthSweep& sweep, double above = 0,
                                             double below = 1e300) {
  const auto points = points_of(sweep, above, below);
  return points.size() >= 6 ? fitted("slope_break", points) : std::nullopt;
}

struct Slopes {
  std::optional<Estimate> a1, a2, b;
  std::optional<Estimate> bend_1, bend_2;  ///< K_m of the bend of A1 and A2 together, and of A2 and B
};
Slopes slopes_of(const StrengthSweep& crystal) {
  if (!crystal.first_slips || !crystal.convection) return {};
  const double a1 = *crystal.first_slips->low, a2 = *crystal.first_slips->high, b = crystal.convection->value;
  const auto bend = [&](double above, double below) -> std::optional<Estimate> {
    const auto fit = bend_of(crystal, above, below);
    return fit ? std::optional(parameter(*fit, "x_b")) : std::nullopt;
  };
  return {slope_of(crystal, 0, a1), slope_of(crystal, a2, b), slope_of(crystal, b, 1e300), bend(0, b),
          bend(a2, 1e300)};
}

/// Whether a bend lies at the border of two regions.
Verdict bends_at(const std::optional<Estimate>& bend, const Estimate& border) {
  return bend ? agree(*bend, border, kBreakError) : Verdict::inconclusive;
}

/// Whether the place of the bend is a property of the curve or of the window in which it is fitted: the bends
/// without the weakest and without the strongest drives, and that of crystals, which convect later.
std::string doubt_of_bend(const HeightSweeps& all, const calibration::CurveFit& bend) {
  constexpr double kWeakest = 1.6, kStrongest = 16.5;  // K_m: Gamma of about 1.26 and 4
  double least = parameter(bend, "x_b").value, most = least;
  for (const auto& window : {bend_of(all.random, kWeakest), bend_of(all.random, 0, kStrongest)})
    if (window) {
      least = std::min(least, parameter(*window, "x_b").value);
      most = std::max(most, parameter(*window, "x_b").value);
    }
  if (most - least <= kBreakError) return {};
  std::string doubt = fmt::format(
      "the bend lies between K_m {:.3g} and {:.3g}, depending on whether points below K_m {:g} or above {:g} "
      "count: the curve bends everywhere",
      least, most, kWeakest, kStrongest);
  if (const auto crystal = bend_of(all.crystal); crystal && all.crystal.convection)
    doubt += fmt::format("; crystals, which convect from K_m {:.3g} on, bend at {:.3g}",
                         all.crystal.convection->value, parameter(*crystal, "x_b").value);
  return doubt;
}

std::vector<Target> targets_of(const HeightSweeps& all, const std::optional<calibration::CurveFit>& bend) {
  std::vector<Target> targets = {rise_of(all.random)};
  Target at{"(a) random: change of slope", "K_m 3.3 +- 0.8", "", Verdict::absent, ""};
  Target same{"(a) random: change of slope where convection begins",
              "the same K_m within 0.8, the error of the first", "", Verdict::absent, ""};
  if (bend) {
    const Estimate x_b = parameter(*bend, "x_b");
    at.measured = fmt::format("K_m {}, slopes {} and {}", x_b.text(), parameter(*bend, "s_1").text(),
                              parameter(*bend, "s_2").text());
    at.verdict = judge(x_b, kBreak - kBreakError, kBreak + kBreakError);
    if (!(bend->p_nested < 0.05)) {
      at.verdict = Verdict::inconclusive;
      at.reason = "one straight line does as well";
    }
    const std::string doubt = doubt_of_bend(all, *bend);
    if (!doubt.empty()) {
      at.verdict = Verdict::inconclusive;
      at.reason = doubt;
    }
    if (all.random.convection) {
      same.measured =
          fmt::format("slope at K_m {}, convection from K_m {}", x_b.text(), all.random.convection->text());
      same.verdict = doubt.empty() ? agree(x_b, *all.random.convection, kBreakError) : Verdict::inconclusive;
      same.reason = doubt;
    }
  }
  targets.push_back(at);
  targets.push_back(same);
  targets.push_back(rise_of(all.crystal));
  Target three{"(b) crystal: three slopes A1, A2, B",
               "each differs from its neighbour, and the curve bends where one region ends, within K_m 0.8",
               "", Verdict::absent, ""};
  const Slopes s = slopes_of(all.crystal);
  const auto text = [](const std::optional<Estimate>& e) { return e ? e->text() : "too few points"; };
  if (s.a1 || s.a2 || s.b) {
    three.measured = fmt::format(
        "A1 {}, A2 {}, B {}; A1 ends at K_m {}, the bend of A1 and A2 together: {}; B begins at K_m {}, the "
        "bend of A2 and B: {}",
        text(s.a1), text(s.a2), text(s.b), all.crystal.first_slips->text(), text(s.bend_1),
        all.crystal.convection->text(), text(s.bend_2));
    three.verdict =
        s.a1 && s.a2 && s.b
            ? all_of({differ(*s.a1, *s.a2), differ(*s.a2, *s.b), bends_at(s.bend_1, *all.crystal.first_slips),
                      bends_at(s.bend_2, *all.crystal.convection)})
            : Verdict::inconclusive;
    if (three.verdict == Verdict::fail) three.reason = "the slope changes everywhere, not at the borders";
  } else {
    three.reason = "slips or convection not found in the sweep";
  }
  targets.push_back(three);
  return targets;
}

/// gnuplot commands for the name of a region between two K_m.
std::string region(const char* name, double from, double to) {
  return fmt::format("set label '{}' at first {:.5g},graph 0.06 center\n", name, std::sqrt(from * to));
}

/// A panel of the figure: points of one start at one height, borders of the regions, fitted line.
/// \param index of the data block \param bend of random beds \param last K_m at the end of the axis
std::string panel_of(const StrengthSweep& l, int layers, std::size_t index,
                     const std::optional<calibration::CurveFit>& bend, double last) {
  std::string plot = "unset arrow\nunset label\n" +
                     analysis::figure_style::panel_title(static_cast<char>('a' + index), title_of(l, layers));
  if (l.is_random()) plot += analysis::figure_style::stated_x(kBreak);
  if (l.convection) {
    plot += border_of_region(l.convection->value) + region("B", l.convection->value, last);
    const double a_from = 1.35;
    if (l.is_random() || !l.first_slips || l.first_slips->value >= l.convection->value)
      plot += region("A", a_from, l.convection->value);
    else
      plot += border_of_region(l.first_slips->value) + region("A_1", a_from, l.first_slips->value) +
              region("A_2", l.first_slips->value, l.convection->value);
  }
  std::string law;
  if (l.is_random() && bend) {
    const double x = parameter(*bend, "x_b").value, y = std::log(bend->at(x));
    plot += fmt::format("f(x) = exp({:.8g} + (x < {:.8g} ? {:.8g} : {:.8g})*log(x/{:.8g}))\n", y, x,
                        parameter(*bend, "s_1").value, parameter(*bend, "s_2").value, x);
    law = fmt::format(", [1.4:*] f(x) with lines lw {} lc rgb '#333333' notitle",
                      analysis::figure_style::kCurve);
  }
  if (l.points.empty()) return plot + "plot NaN notitle\n";
  return plot + fmt::format(
                    "plot 'p1-fig4.dat' index {} using 1:2:3:4 with yerrorbars pt {} lc rgb '{}' notitle{}\n",
                    index, symbol_of(l), colour_of(l), law);
}

analysis::Figure figure_of(const StrengthSweeps& all) {
  const int rows = static_cast<int>(all.heights.size());
  analysis::Figure f{
      .name = "p1-fig4", .title = "Granular temperature", .width = 720, .height = 80 + 370 * rows};
  analysis::figure_style::PlotAxis k_m{.label = "K_m = A^2 ω^2/(σ g)", .logarithmic = true},
      t_g{.label = "T_g/(m g σ)", .logarithmic = true};
  for (const HeightSweeps& height : all.heights)
    for (const StrengthSweep* l : {&height.random, &height.crystal})
      for (const SweepPoint& r : l->points) {
        const Estimate t = r.mean_temperature();
        k_m.show(r.k_m());
        t_g.show(t.value);
        t_g.show(t.high.value_or(t.value));
      }
  const analysis::figure_style::Panels panels(all.heights.size(), 2, f.width, f.height, 3);
  f.plot = analysis::figure_style::Panels::begin() + analysis::figure_style::axes(k_m, t_g);
  const double last = k_m.with_margin().high, floor = t_g.with_margin().low;
  std::size_t index = 0;
  for (const HeightSweeps& height : all.heights) {
    const auto bend = bend_of(height.random);
    for (const StrengthSweep* l : {&height.random, &height.crystal}) {
      f.data +=
          fmt::format("# {}, N_l = {}: K_m, T_g*, low, high, convecting share\n", l->start, height.layers);
      for (const SweepPoint& r : l->points) {
        const Estimate t = r.mean_temperature();
        f.data += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.3g}\n", r.k_m(), t.value,
                              std::max(t.low.value_or(t.value), floor), t.high.value_or(t.value),
                              static_cast<double>(r.convecting) / static_cast<double>(r.runs));
      }
      if (l->points.empty()) f.data += "? ? ? ? ?\n";
      f.data += "\n\n";
      f.plot += panels.panel(index) + panel_of(*l, height.layers, index, bend, last);
      ++index;
    }
  }
  f.plot +=
      panels.end({key_of_starts(),
                  fmt::format("keyentry with lines lw {} lc rgb '#333333' title 'two power laws'",
                              analysis::figure_style::kCurve),
                  key_of_border(), analysis::figure_style::stated_line_entry("paper: bend at K_m = 3.3")});
  f.caption =
      "T_g* against K_m from random beds (left) and crystals (right), mean over runs with 95 % intervals. "
      "Thin dashed: onset of convection (s_c > σ), right of which is region B; for crystals also the first "
      "slips, left of which is A1. Line: two power laws that meet. Thick dashed: where the paper's slope "
      "changes. Form of Fortini & Huang 2015, Fig. 4.";
  return f;
}

Reproduction run(const Request& request) {
  const StrengthSweeps all = strength_sweeps(request);
  Reproduction r = reproduction_of(all, "Fortini & Huang 2015, Fig. 4: granular temperature against K_m");
  r.targets = targets_at_heights(all, temperature_targets);
  r.figures = {figure_of(all)};
  return r;
}

}  // namespace

std::vector<Target> temperature_targets(const HeightSweeps& sweeps) {
  return targets_of(sweeps, bend_of(sweeps.random));
}

Reproducible p1_fig4() {
  return {.name = "p1-fig4",
          .what = "granular temperature against K_m, random and crystal starts",
          .run = run,
          .shared_runs = kStrengthSweepRuns,
          .judges_stored = true,
          .on_device = true,
          .time_share = 4};
}

}  // namespace twincell::reproduce
