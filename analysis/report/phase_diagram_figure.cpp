#include "analysis/report/phase_diagram_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "analysis/report/phase_signs.hpp"
namespace twincell::analysis {
namespace {

constexpr const char* kOnsetColours[] = {colours::kBlue, colours::kVermilion};  // bouncing, convection

/// The brackets of the runs' onsets as bars beside the symbols: commands before the plot, and key entries.
struct OnsetBars {
  std::string commands, key;
};
OnsetBars onset_bars(const std::vector<PhaseBoundary>& boundaries, double aside) {
  constexpr int kOpenDiamond = 12, kOpenPentagon = 14;  // the filled symbol is the next one
  OnsetBars bars;
  std::set<std::string> named;
  for (const PhaseBoundary& b : boundaries) {
    if (b.sweep || !b.below || !b.above) continue;
    const bool experiment = b.side == Side::experiment, bounces = b.onset == BedPhase::bouncing;
    const double x = b.n_l + (experiment ? -aside : aside);
    const char* colour = kOnsetColours[bounces ? 0 : 1];
    const int symbol = (bounces ? kOpenDiamond : kOpenPentagon) + (experiment ? 0 : 1);
    bars.commands += fmt::format(
        "set arrow from {0:.6g},{1:.6g} to {0:.6g},{2:.6g} heads size graph 0.01,90 lw 1.5 lc rgb '{3}'\n"
        "set label '' at {0:.6g},{4:.6g} point pt {5} ps 1.3 lw 1.5 lc rgb '{3}'\n",
        x, *b.below, *b.above, colour, (*b.below + *b.above) / 2, symbol);
    const std::string title = fmt::format("onset of {}, {}", onset_name(b.onset), side_name(b.side));
    if (named.insert(title).second)
      bars.key += fmt::format(", keyentry with points pt {} ps 1.3 lw 1.5 lc rgb '{}' title '{}'", symbol,
                              colour, title);
  }
  return bars;
}

/// Shades the phases between the onsets of one side, simulation if it has them; the brackets stay blank. Only
/// for beds of one height.
std::string shaded_phases(const std::vector<PhaseBoundary>& boundaries, const PlotRange& y) {
  std::string commands;
  for (const Side side : {Side::simulation, Side::experiment}) {
    const auto onset = [&](BedPhase phase) -> const PhaseBoundary* {
      const PhaseBoundary* found = nullptr;
      for (const PhaseBoundary& b : boundaries)
        if (!b.sweep && b.side == side && b.onset == phase && b.below && b.above) {
          if (found != nullptr) return nullptr;  // several starts or heights
          found = &b;
        }
      return found;
    };
    const PhaseBoundary *bounce = onset(BedPhase::bouncing), *convect = onset(BedPhase::convecting);
    const auto shade = [&](double low, double high, BedPhase phase) {
      if (high > low)
        commands += fmt::format(
            "set object rectangle from graph 0, first {:.6g} to graph 1, first {:.6g} behind fc rgb '{}' fs "
            "transparent solid 0.15 noborder\n",
            low, high, phase_colour(phase));
    };
    if (bounce != nullptr) shade(y.low, *bounce->below, BedPhase::co_moving);
    if (bounce != nullptr && convect != nullptr) shade(*bounce->above, *convect->below, BedPhase::bouncing);
    if (convect != nullptr) shade(*convect->above, y.high, BedPhase::convecting);
    if (!commands.empty()) return commands;
  }
  return commands;
}

}  // namespace

Figure phase_diagram_figure(const std::vector<Run>& runs, const std::vector<PhaseBoundary>& boundaries) {
  Figure f{.name = "phase_diagram", .title = "Phase diagram", .width = 660, .height = 560};
  PlotRange n_l;
  bool one_omega = true;
  for (const Run& run : runs) {
    n_l.add(run.n_l);
    one_omega = one_omega && std::abs(run.omega - runs.front().omega) <= 1e-3 * runs.front().omega;
  }
  const PlotRange x = n_l.padded(0.12, 5);
  // Symbols of both sides at the same (N_l, Gamma) are drawn side by side, so that neither hides the other.
  const double aside = 0.014 * (x.high - x.low);
  const std::string clauses = phase_blocks(runs, f.name, f.data, [&](const Run& run) {
    return fmt::format("{} {} {} # {}\n", run.n_l + (run.side == Side::experiment ? -aside : aside),
                       run.gamma, run.k_m, gnuplot_plain_text(run.name));
  });
  const PlotRange y = gamma_range(runs);
  f.plot =
      fmt::format("set xlabel 'N_l σ'\nset ylabel 'Γ = A ω^2 / g'\nset xrange [{}:{}]\nset yrange [{}:{}]\n",
                  x.low, x.high, y.low, y.high);
  if (one_omega) {
    const double square = runs.front().omega * runs.front().omega;
    f.plot += fmt::format(
        "set ytics nomirror\nset y2label 'K_m = A^2 ω^2 / σ g'\nset link y2 via y**2/{0} inverse "
        "sqrt(y*{0})\nset y2tics {1}\n",
        square, tic_step({y.low * y.low / square, y.high * y.high / square}));
  }
  constexpr double kBarsAside = 3;
  const OnsetBars bars = onset_bars(boundaries, kBarsAside * aside);
  const std::string shaded = shaded_phases(boundaries, y);
  f.plot +=
      shaded + bars.commands +
      "set key outside below center vertical maxrows 5 samplen 1 spacing 1.1 width -2 Left reverse\nplot " +
      clauses + phase_key(runs) + bars.key + "\n";
  f.caption =
      "Phases of the bed over its number of layers and the strength of the drive. Open symbols: experiment "
      "(drawn a little to the left); filled: simulation (a little to the right).";
  if (!bars.key.empty()) f.caption += " Bars: the onset lies between the two drive strengths.";
  if (!shaded.empty()) f.caption += " Shaded: the phases between the onsets; blank: undecided.";
  if (!one_omega) f.caption += " The runs differ in ω, so there is no common K_m axis.";
  return f;
}

Figure phase_strip_figure(const std::vector<Run>& runs) {
  Figure f{.name = "phase_strip", .title = "Phases along the drive strength", .height = 300};
  const std::string clauses = phase_blocks(runs, f.name, f.data, [](const Run& run) {
    return fmt::format("{} {} # {}\n", run.gamma, run.side == Side::experiment ? 1 : 0,
                       gnuplot_plain_text(run.name));
  });
  const PlotRange x = gamma_range(runs);
  f.plot = fmt::format(
      "set xlabel 'Γ = A ω^2 / g'\nset xrange [{}:{}]\nset yrange [-0.6:1.6]\nset ytics ('experiment' 1, "
      "'simulation' 0)\n",
      x.low, x.high);
  f.plot +=
      "set key outside below center vertical maxrows 3 samplen 1 spacing 1.1 width -2 Left reverse\nplot " +
      clauses + phase_key(runs) + "\n";
  f.caption = "The same phases along the drive strength, one row per side.";
  return f;
}

}  // namespace twincell::analysis
