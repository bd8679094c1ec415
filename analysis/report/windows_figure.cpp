#include "analysis/report/windows_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"

namespace twincell::analysis {
namespace {

/// What a figure has at its abscissa: the middle of a window, and whether the number falls in it.
struct Place {
  double at;
  bool falls;
};
struct Abscissa {
  std::string label;
  std::vector<Place> places;  ///< of each window
};

Abscissa abscissa_of(const std::vector<Window>& windows) {
  const auto of = [&](const char* label, auto number) {
    Abscissa a{.label = label, .places = {}};
    for (const Window& w : windows) {
      const double begin = number((*w.drive)[0]), end = number((*w.drive)[1]);
      a.places.push_back({(begin + end) / 2, end < begin});
    }
    return a;
  };
  const auto changes = [&](auto number) {
    constexpr double kSame = 1e-9;
    return std::any_of(windows.begin(), windows.end(), [&](const Window& w) {
      return w.drive && std::abs(number((*w.drive)[1]) - number((*windows.front().drive)[0])) >
                            kSame * number((*windows.front().drive)[0]);
    });
  };
  const auto gamma = [](const Drive& d) { return d.gamma(); };
  const auto omega = [](const Drive& d) { return d.omega; };
  if (windows.front().drive && changes(gamma)) return of("Γ", gamma);
  if (windows.front().drive && changes(omega)) return of("ω t_0", omega);
  Abscissa a{.label = "first cycle of the window", .places = {}};
  for (const Window& w : windows) a.places.push_back({static_cast<double>(w.first_cycle), false});
  return a;
}

Figure figure_of(const std::string& name, const std::vector<Window>& windows, const Abscissa& abscissa) {
  Figure f{.name = "windows_" + name, .title = name + " in windows"};
  f.height = 400;
  const Result& first = find_result(windows.front().results, name);
  std::string unit = first.unit.empty() || first.unit == "1" ? "" : "/" + first.unit;
  if (const std::size_t sigma = unit.find("sigma"); sigma != std::string::npos)
    unit = unit.substr(0, sigma) + "σ" + unit.substr(sigma + 5);
  figure_style::PlotAxis x{.label = abscissa.label}, y{.label = gnuplot_symbol(name) + unit};
  bool both[2] = {false, false};
  for (const bool falls : {false, true}) {
    f.data += fmt::format("# {}: {}, {}, low, high of its interval\n", falls ? "falling" : "rising",
                          abscissa.label, name);
    for (std::size_t k = 0; k < windows.size(); ++k) {
      if (abscissa.places[k].falls != falls) continue;
      const Result& r = find_result(windows[k].results, name);
      if (!std::isfinite(r.value())) continue;
      const double low = r.interval ? r.interval->low : r.value(),
                   high = r.interval ? r.interval->high : r.value();
      f.data += fmt::format("{:.6g} {} {} {}\n", abscissa.places[k].at, gnuplot_number(r.value()),
                            gnuplot_number(low), gnuplot_number(high));
      x.show(abscissa.places[k].at);
      for (const double v : {r.value(), low, high}) y.show(v);
      both[falls ? 1 : 0] = true;
    }
    if (!both[falls ? 1 : 0]) f.data += "? ? ? ?\n";
    f.data += "\n\n";
  }
  const auto series = [&](int index, int point, const char* colour, const char* title) {
    return fmt::format(
        "'{0}.dat' index {1} using 1:2:3:4 with yerrorlines pt {2} ps 0.8 lw {3} lc rgb '{4}' {5}", f.name,
        index, point, figure_style::kLine, colour, title);
  };
  using figure_style::kCircle;
  f.plot = figure_style::axes(x, y) + "plot " +
           series(0, kCircle, colours::kBlue, both[1] ? "title 'rising'" : "notitle");
  if (both[1])
    f.plot += ", " + series(1, figure_style::unfilled(kCircle), colours::kVermilion, "title 'falling'");
  f.plot += '\n';
  f.caption = fmt::format("{} in windows of {} cycles, at the middle of each window, with 95 % intervals.",
                          name, windows.front().cycles);
  return f;
}

}  // namespace

std::vector<Figure> windows_figures(const std::vector<Window>& windows,
                                    const std::vector<std::string>& only) {
  const Abscissa abscissa = abscissa_of(windows);
  std::vector<Figure> figures;
  for (const Result& r : windows.front().results) {
    const bool usual =
        std::find(std::begin(kWindowNumbers), std::end(kWindowNumbers), r.name) != std::end(kWindowNumbers);
    if (!r.shape.empty() || (only.empty() && !usual)) continue;
    // A word has no figure, and neither has a number that no window has.
    if (std::none_of(windows.begin(), windows.end(), [&](const Window& w) {
          const Result& other = find_result(w.results, r.name);
          return other.text.empty() && std::isfinite(other.value());
        }))
      continue;
    figures.push_back(figure_of(r.name, windows, abscissa));
  }
  return figures;
}

}  // namespace twincell::analysis
