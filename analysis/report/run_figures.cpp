#include "analysis/report/run_figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "analysis/report/phase_signs.hpp"
namespace twincell::analysis {
namespace {

using namespace colours;

/// Distinct Gamma of all runs, ascending; values within 0.5 % count once.
std::vector<double> distinct_gammas(const std::vector<Run>& runs) {
  std::vector<double> gammas;
  gammas.reserve(runs.size());
  for (const Run& run : runs) gammas.push_back(run.gamma);
  std::sort(gammas.begin(), gammas.end());
  std::vector<double> distinct;
  for (const double g : gammas)
    if (distinct.empty() || g > 1.005 * distinct.back()) distinct.push_back(g);
  return distinct;
}

std::string gamma_colour(const std::vector<double>& gammas, double gamma) {
  const auto above = std::upper_bound(gammas.begin(), gammas.end(), gamma);
  const auto i = above == gammas.begin() ? 0 : static_cast<std::size_t>(above - gammas.begin()) - 1;
  return figure_style::ordered_colour(i, gammas.size());
}

/// One panel per side with one curve per run, coloured in order of Gamma. `points(run)` returns the data
/// block of a run ("" if absent).
template <class Points>
std::string curve_panels(const std::vector<Run>& runs, const std::string& name, std::string& data,
                         const std::string& extra_clause, const Points& points) {
  const auto gammas = distinct_gammas(runs);
  std::string plot;
  int index = 0;
  for (const Side side : kSides) {
    std::vector<std::string> clauses;
    if (!extra_clause.empty()) clauses.push_back(extra_clause);
    bool any = false;
    for (const double gamma : gammas) {
      bool named = false;  // runs with the same Gamma share a colour and one entry in the key
      for (const Run& run : runs) {
        if (run.side != side || gamma_colour(gammas, run.gamma) != gamma_colour(gammas, gamma)) continue;
        const std::string block = points(run);
        if (block.empty()) continue;
        any = true;
        data += fmt::format("# {} {} Gamma {:.4g}\n{}\n\n", side_name(side), gnuplot_plain_text(run.name),
                            run.gamma, block);
        clauses.push_back(
            fmt::format("'{}.dat' index {} using 1:2 with linespoints pt {} ps 0.7 lw 1.8 lc rgb '{}' {}",
                        name, index++, side == Side::simulation ? 7 : 6, gamma_colour(gammas, run.gamma),
                        named ? "notitle" : fmt::format("title 'Γ = {:.3g}'", gamma)));
        named = true;
      }
    }
    if (!any) clauses.emplace_back("NaN notitle");
    plot += figure_style::panel_title(side == kSides.front() ? 'a' : 'b', side_name(side));
    if (!any) plot += "set label 99 'no value' at graph 0.5,0.5 center\n";
    plot += fmt::format("plot {}\nunset label 99\n", fmt::join(clauses, ", "));
  }
  return plot;
}

}  // namespace

Figure thresholds_figure(const std::vector<Run>& runs) {
  Figure f{.name = "thresholds", .title = "s_b and s_c against the drive strength", .height = 740};
  static constexpr double kFloor = 1e-5;  // the logarithmic axes cannot show zero
  const PlotRange x = gamma_range(runs);
  f.plot = fmt::format(
      "set multiplot layout 2,1\nset logscale y\nset format y '10^{{%T}}'\nset xrange [{}:{}]\nset xlabel 'Γ "
      "= A ω^2 / g'\nset lmargin 10\n",
      x.low, x.high);
  int index = 0;
  for (const char* name : {"s_b", "s_c"}) {
    const bool bounce = std::string(name) == "s_b";
    std::string clauses;
    PlotRange y;
    y.add(bounce ? kBouncingThreshold : kConvectionThreshold);
    for (const Side side :
         kSides) {  // small filled symbols are drawn over large open ones, so both are visible
      std::string block;
      std::vector<const Run*> ordered;
      for (const Run& run : runs)
        if (run.side == side) ordered.push_back(&run);
      std::stable_sort(ordered.begin(), ordered.end(),
                       [](const Run* a, const Run* b) { return a->gamma < b->gamma; });
      for (const Run* run : ordered) {
        const Result& r = find_result(run->results, name);
        if (!r.present()) continue;
        const double low = r.interval ? r.interval->low : r.value(),
                     high = r.interval ? r.interval->high : r.value();
        const auto at_least_floor = [](double v) { return std::max(v, kFloor); };
        block +=
            fmt::format("{} {} {} {} {} # {}\n", run->gamma, at_least_floor(r.value()), at_least_floor(low),
                        at_least_floor(high), r.value(), gnuplot_plain_text(run->name));
        y.add(at_least_floor(r.value()));
        y.add(at_least_floor(low));
        y.add(at_least_floor(high));
      }
      if (block.empty()) continue;
      f.data += fmt::format("# {} {}: Gamma, value and interval as drawn, value\n{}\n\n", name,
                            side_name(side), block);
      const char* colour = side == Side::experiment ? "#222222" : kBlue;
      const int point = side == Side::experiment ? 6 : 7;
      clauses += fmt::format(
          ", '{0}.dat' index {1} using 1:2 with lines lw 1 dt {2} lc rgb '{3}' notitle, '' index {1} using "
          "1:2:3:4 with yerrorbars pt {4} ps {5} lw 1.6 lc rgb '{3}' title '{6}'",
          f.name, index++, side == Side::experiment ? 2 : 1, colour, point,
          side == Side::experiment ? 1.6 : 0.9, side_name(side));
    }
    f.plot += fmt::format("set ylabel '{} / σ'\nset yrange [{}:{}]\nset key {}\n", name, y.low / 2,
                          y.high * 2, "outside below center horizontal samplen 1.5 width -1 Left reverse");
    f.plot += fmt::format("plot {} with lines dt 4 lw 1.5 lc rgb '{}' title '{}'{}\n",
                          bounce ? "1.0/30" : "1.0", kVermilion, bounce ? "σ/30" : "σ", clauses);
  }
  f.plot += "unset multiplot\n";
  f.caption =
      "Top: s_b, the variation of the bed's height above the plate through a cycle; above σ/30 the bed "
      "bounces. Bottom: s_c, the deformation of the tracer line; above σ the bed convects. Bars: 95 % "
      "intervals (s_b by bootstrap over tracers, s_c as a correlated series over cycles). "
      "Values below 10⁻⁵ are drawn at 10⁻⁵.";
  return f;
}

Figure s_k_figure(const std::vector<Run>& runs) {
  Figure f{.name = "s_k", .title = "Height of the tracers above the plate through a cycle", .height = 740};
  PlotRange y;
  const auto block = [&](const Run& run) -> std::string {
    const Result& s = find_result(run.results, "s_k");
    if (!s.present()) return {};
    double mean = 0;
    for (const double v : s.values) mean += v / static_cast<double>(s.values.size());
    std::string text;
    for (std::size_t k = 0; k < s.values.size(); ++k) {
      y.add(s.values[k] - mean);
      text += fmt::format("{} {} {}\n", static_cast<double>(k) / static_cast<double>(s.values.size()),
                          s.values[k] - mean, s.values[k]);
    }
    return text;
  };
  const std::string panels = curve_panels(runs, f.name, f.data, "", block);
  const PlotRange range = y.padded(0.05, 0.02);
  f.plot = fmt::format(
      "set multiplot layout 2,1\nset xrange [0:1]\nset yrange [{}:{}]\nset xlabel 'phase k / N_k'\nset "
      "ylabel 's(k) − mean, σ'\nset lmargin 9\n"
      "set key outside right top vertical samplen 1.5 Left reverse\n{}unset multiplot\n",
      range.low, range.high, panels);
  f.caption =
      "Mean height of the tracers above the plate in each phase of the drive, minus its mean over the cycle; "
      "s_b is the root mean square of each curve.";
  return f;
}

Figure s_j_figure(const std::vector<Run>& runs) {
  Figure f{.name = "s_j", .title = "Spread of the tracer line, cycle by cycle", .height = 740};
  PlotRange y;
  y.add(0);
  y.add(kConvectionThreshold);
  const auto block = [&](const Run& run) -> std::string {
    const Result& s = find_result(run.results, "s_j");
    if (!s.present()) return {};
    std::string text;
    for (std::size_t j = 0; j < s.values.size(); ++j) {
      y.add(s.values[j]);
      text += std::isfinite(s.values[j]) ? fmt::format("{} {}\n", j, s.values[j]) : fmt::format("{} ?\n", j);
    }
    return text;
  };
  const std::string threshold = fmt::format("1 with lines dt 4 lw 1.5 lc rgb '{}' title 'σ'", kVermilion);
  const std::string panels = curve_panels(runs, f.name, f.data, threshold, block);
  const PlotRange range = y.padded(0.05, 0.02);
  f.plot = fmt::format(
      "set multiplot layout 2,1\nset yrange [{}:{}]\nset xlabel 'cycle j since the first analysed'\nset "
      "ylabel 's_j / σ'\nset lmargin 9\nset key outside right top vertical samplen 1.5 Left reverse\n"
      "{}unset multiplot\n",
      range.low, range.high, panels);
  f.caption =
      "Spread of the tracers' heights at the beginning of each cycle. A curve that rises and then stays "
      "constant shows rearrangement, not steady convection.";
  return f;
}

}  // namespace twincell::analysis
