#include "analysis/report/spatial_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"

namespace twincell::analysis {
namespace {

using namespace colours;

/// Colour and name of a class of beads in the lattice figure.
struct BeadStyle {
  const char* colour;
  const char* name;
};
constexpr std::array<BeadStyle, 4> kLattice = {{{kSky, "A: rows along the floor"},
                                                {colours::kGreen, "between"},
                                                {kOrange, "B: rows along the walls"},
                                                {kPale, "ψ6 below 0.9"}}};
std::size_t style_of(double psi6, double angle) {
  if (!(psi6 > kOrdered)) return 3;
  if (misorientation(angle, 0) <= 10) return 0;
  return misorientation(angle, 30) <= 10 ? 2 : 1;
}

/// The part of the bed that the lattice figure shows, sigma, and its scale in the drawing.
struct LatticeView {
  double left, right, low, high;
  double scale;  ///< px per sigma
};

/// Margin at the left, right and bottom of the drawing, and height of its legend, px.
constexpr double kLatticeMargin = 12, kLatticeLegend = 66;

LatticeView lattice_view(const Frame& frame, const Box& box, int width_px) {
  const double left = box.lower.x(), right = box.upper.x();
  std::vector<double> heights;
  double low = box.lower.z();
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    if (frame.present(i) && frame.position[i].allFinite()) {
      heights.push_back(frame.position[i].z());
      low = std::min(low, frame.position[i].z() - 0.5);
    }
  std::sort(heights.begin(), heights.end());
  // A single bead thrown high must not shrink the bed.
  const double high =
      heights.empty() ? low + 1
                      : heights[static_cast<std::size_t>(0.99 * static_cast<double>(heights.size() - 1))] + 2;
  return {left, right, low, high, (width_px - 2 * kLatticeMargin) / (right - left)};
}

/// Symbols of the beads, and the same as data.
struct LatticeSymbols {
  std::array<std::string, 4> circles;  ///< SVG, of each style
  std::string marks;                   ///< SVG, of beads with five and seven neighbours
  std::string data;
};

LatticeSymbols lattice_symbols(const Frame& frame, const TrajectoryInfo& info, const VoronoiCells& cells,
                               const LatticeView& view) {
  const BondOrder order = bond_order(cells.neighbours, cells.edge);
  const auto& [left, right, low, high, scale] = view;
  LatticeSymbols s;
  s.data = "# x, z, radius, class (0 A, 1 between, 2 B, 3 disordered), Voronoi neighbours (0 at a surface)\n";
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i) || !frame.position[i].allFinite() || frame.position[i].z() > high) continue;
    const Vec3 r = info.box.wrap(frame.position[i]);
    const double radius = radius_of(info.radius, i);
    const std::size_t style = style_of(order.psi6[i], order.angle[i]);
    const std::size_t neighbours = cells.enclosed[i] != 0 ? cells.neighbours.count(i) : 0;
    s.data += fmt::format("{:.5f} {:.5f} {:.4g} {} {}\n", r.x(), r.z(), radius, style, neighbours);
    const double x = kLatticeMargin + scale * (r.x() - left), y = scale * (high - r.z());
    s.circles[style] +=
        fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.3g}\"/>\n", x, y, scale * radius);
    const double half = 0.28 * scale;
    if (neighbours == 5)
      s.marks += fmt::format("<path d=\"M{:.2f} {:.2f}l{:.2f} {:.2f}h{:.2f}z\" fill=\"{}\"/>\n", x, y - half,
                             half, 2 * half, -2 * half, kVermilion);
    else if (neighbours == 7)
      s.marks +=
          fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
                      x - half, y - half, 2 * half, 2 * half, kBlue);
  }
  return s;
}

/// SVG drawing with true circles, which gnuplot does not draw, and with the legend.
std::string lattice_svg(const LatticeSymbols& symbols, const LatticeView& view, int width_px, int height_px) {
  const auto& [left, right, low, high, scale] = view;
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 "
      "{0} {1}\" font-family=\"Arial, sans-serif\" font-size=\"14\">\n<rect width=\"{0}\" height=\"{1}\" "
      "fill=\"white\"/>\n",
      width_px, height_px);
  for (std::size_t s = 0; s < symbols.circles.size(); ++s)
    svg += fmt::format("<g fill=\"{}\" stroke=\"#555555\" stroke-width=\"0.6\">\n{}</g>\n",
                       kLattice[s].colour, symbols.circles[s]);
  svg += fmt::format("<g stroke=\"#222222\" stroke-width=\"0.6\">\n{}</g>\n", symbols.marks);
  const double floor = scale * (high - low);
  svg += fmt::format(
      "<path d=\"M{0:.1f} 0V{1:.1f}H{2:.1f}V0\" fill=\"none\" stroke=\"#222222\" stroke-width=\"2\"/>\n",
      kLatticeMargin, floor + 1, kLatticeMargin + scale * (right - left));
  for (std::size_t s = 0; s < kLattice.size(); ++s)
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7\" fill=\"{2}\" stroke=\"#555555\"/><text x=\"{3:.1f}\" "
        "y=\"{4:.1f}\">{5}</text>\n",
        20 + 265.0 * static_cast<double>(s % 2), floor + 22 + 20 * static_cast<double>(s / 2),
        kLattice[s].colour, 33 + 265.0 * static_cast<double>(s % 2),
        floor + 27 + 20 * static_cast<double>(s / 2), kLattice[s].name);
  svg += fmt::format(
      "<path d=\"M484 {0:.1f}l6 12h-12z\" fill=\"{2}\"/><text x=\"496\" y=\"{1:.1f}\">5</text>"
      "<rect x=\"508\" y=\"{0:.1f}\" width=\"11\" height=\"11\" fill=\"{3}\"/><text x=\"524\" "
      "y=\"{1:.1f}\">7</text>\n</svg>\n",
      floor + 36, floor + 47, kVermilion, kBlue);
  return svg;
}

/// gnuplot script for the other formats. \param name of the file of the data, without its ending
std::string lattice_plot(const LatticeView& view, const std::string& name) {
  const auto& [left, right, low, high, scale] = view;
  std::string plot = fmt::format(
      "set size ratio -1\nunset tics\nunset grid\nunset border\nset xrange [{0}:{1}]\nset yrange [{2}:{3}]\n"
      "set key outside below center maxrows 3 samplen 1 Left reverse\n"
      "set arrow 1 from {0},{2} to {0},{3} nohead lw 2\nset arrow 2 from {1},{2} to {1},{3} nohead lw 2\n"
      "set arrow 3 from {0},{2} to {1},{2} nohead lw 2\nplot ",
      left, right, low, high);
  for (std::size_t s = 0; s < kLattice.size(); ++s)
    plot += fmt::format(
        "'{0}.dat' using ($4=={1}?$1:NaN):2:3 with circles fs solid border lc rgb '#555555' lw 0.5 fc rgb "
        "'{2}' notitle, keyentry with points pt 7 ps 1.4 lc rgb '{2}' title '{3}', ",
        name, s, kLattice[s].colour, kLattice[s].name);
  plot += fmt::format(
      "'{0}.dat' using 1:($5==5?$2:NaN) with points pt 9 ps 1 lc rgb '{1}' title '5 neighbours', '{0}.dat' "
      "using 1:($5==7?$2:NaN) with points pt 5 ps 0.8 lc rgb '{2}' title '7 neighbours'\n",
      name, kVermilion, kBlue);
  return plot;
}

}  // namespace

Figure convection_figure(const std::vector<Result>& results, const Box& box) {
  const Result& u = find_result(results, "displacement_field");
  const Result& x = find_result(results, "field_x");
  const Result& z = find_result(results, "field_z");
  double longest = 0;
  for (std::size_t c = 0; c < u.values.size(); c += 2)
    if (std::isfinite(u.values[c])) longest = std::max(longest, std::hypot(u.values[c], u.values[c + 1]));
  const double cell = x.values.size() > 1 ? x.values[1] - x.values[0] : box.size().x();
  const double scale = longest > 0 ? cell / longest : 1;

  Figure f{.name = "convection_field", .title = "Displacement per cycle"};
  const double top = (z.values.empty() ? 1 : z.values.back()) + cell;
  f.height = static_cast<int>(std::clamp(160 + 430 * (top - box.lower.z()) / box.size().x(), 300.0, 1100.0));
  for (const bool up : {true, false}) {
    f.data += fmt::format("# beads that move {}: x, z, u_x, u_z per cycle (sigma)\n", up ? "up" : "down");
    bool any = false;
    for (std::size_t r = 0; r < z.values.size(); ++r)
      for (std::size_t c = 0; c < x.values.size(); ++c) {
        const std::size_t at = 2 * (r * x.values.size() + c);
        if (!std::isfinite(u.values[at]) || (u.values[at + 1] >= 0) != up) continue;
        any = true;
        f.data +=
            fmt::format("{} {} {:.6g} {:.6g}\n", x.values[c], z.values[r], u.values[at], u.values[at + 1]);
      }
    f.data += any ? "\n\n" : "? ? ? ?\n\n\n";
  }
  f.plot = fmt::format(
      "set size ratio -1\nset title 'longest arrow: {:.3g} σ per cycle'\nset xlabel 'x / σ'\nset ylabel 'z / "
      "σ'\n"
      "set xrange [{}:{}]\nset yrange [{}:{}]\n"
      "set key outside below center horizontal samplen 2\n"
      "s = {:.6g} # magnification\n"
      "plot for [i=0:1] '{}.dat' index i using ($1-s*$3/2):($2-s*$4/2):(s*$3):(s*$4) with vectors filled "
      "head size graph 0.015,20 lw 1.8 lc rgb (i == 0 ? '{}' : '{}') title (i == 0 ? 'up' : 'down')\n",
      longest, box.lower.x(), box.upper.x(), box.lower.z(), top, scale, f.name, kVermilion, kBlue);
  f.caption = fmt::format(
      "Mean displacement between the beginnings of consecutive cycles in cells of {:.3g} σ, magnified {:.3g} "
      "times: the longest arrow is {:.3g} σ per cycle.",
      cell, scale, longest);
  return f;
}

Figure profiles_figure(const std::vector<Result>& results) {
  Figure f{.name = "profiles", .title = "Packing and temperature over height"};
  f.width = 720;
  f.height = 420;
  const Result& z = find_result(results, "profile_z");
  const auto find = [&](const char* name) {
    return std::find_if(results.begin(), results.end(),
                        [&](const Result& r) { return r.name == name && r.present(); });
  };
  const auto column = [&](const char* name, std::size_t k) {
    const auto r = find(name);
    return r != results.end() ? gnuplot_number(r->values[k]) : std::string("?");
  };
  f.data = "# z (sigma), packing fraction, T_z, T_x (m g sigma)\n";
  for (std::size_t k = 0; k < z.values.size(); ++k)
    f.data +=
        fmt::format("{} {} {} {}\n", z.values[k], column("phi_z", k), column("T_z_z", k), column("T_x_z", k));
  figure_style::PlotAxis height{.label = "z/σ"}, packing{.label = "packing fraction", .low = 0},
      temperature{.label = "temperature/(m g σ)", .low = 0};
  const auto show = [&](figure_style::PlotAxis& axis, const char* name) {
    if (const auto r = find(name); r != results.end())
      for (const double v : r->values) axis.show(v);
  };
  show(height, "profile_z");
  show(packing, "phi_z");
  for (const char* name : {"T_z_z", "T_x_z"}) show(temperature, name);
  const figure_style::Panels panels(1, 2, f.width, f.height, 1);
  const std::string line = fmt::format("with linespoints pt {} ps 0.6 lw {} lc rgb", figure_style::kCircle,
                                       figure_style::kCurve),
                    open = fmt::format("with linespoints pt {} ps 0.6 lw {} lc rgb",
                                       figure_style::unfilled(figure_style::kCircle), figure_style::kCurve);
  f.plot =
      figure_style::Panels::begin() + panels.panel(0) + figure_style::axes(packing, height) +
      figure_style::panel_title('a', "packing") +
      fmt::format("plot '{}.dat' using 2:1 {} '{}' notitle\n", f.name, line, kGreen) + panels.panel(1) +
      figure_style::axes(temperature, height) + figure_style::panel_title('b', "temperature") +
      (temperature.empty() ? "set label 'no value' at graph 0.5,0.5 center\nplot NaN notitle\n"
                           : fmt::format("plot '{0}.dat' using 3:1 {1} '{2}' notitle, '' using 4:1 {3} '{4}' "
                                         "notitle\n",
                                         f.name, line, kVermilion, open, kBlue)) +
      panels.end({fmt::format("keyentry {} '{}' title 'vertical'", line, kVermilion),
                  fmt::format("keyentry {} '{}' title 'horizontal'", open, kBlue)});
  f.caption =
      "Slabs one σ thick, mean over all frames. (a) share of the slab that is filled by beads. (b) m⟨(v "
      "− ⟨v⟩)²⟩ of the beads whose centres are in the slab.";
  return f;
}

Figure defect_evolution_figure(const std::vector<Result>& results) {
  Figure f{.name = "defect_evolution", .title = "Defects through time"};
  f.height = 340;
  const Result& series = find_result(results, "defect_fraction_j");
  f.data = fmt::format("# {}, share of enclosed beads that do not have 6 neighbours\n", series.n_of);
  figure_style::PlotAxis time{.label = series.n_of + " since the first analysed"},
      share{.label = "share of beads without 6 neighbours", .low = 0};
  for (std::size_t j = 0; j < series.values.size(); ++j) {
    f.data += fmt::format("{} {}\n", j, gnuplot_number(series.values[j]));
    time.show(static_cast<double>(j));
    share.show(series.values[j]);
  }
  f.plot = figure_style::axes(time, share) +
           fmt::format("plot '{}.dat' using 1:2 with linespoints pt {} ps 0.6 lw {} lc rgb '{}' notitle\n",
                       f.name, figure_style::kCircle, figure_style::kCurve, kBlue);
  f.caption =
      "Share of the beads that do not have six neighbours, without beads at walls, free surfaces and holes.";
  return f;
}

Figure lattice_figure(const Frame& frame, const TrajectoryInfo& info, const AnalysisOptions& options) {
  const VoronoiCells cells = voronoi_cells(frame, info.box, options.cell_radius);
  Figure f{.name = "lattice", .title = "Lattice and defects"};
  const LatticeView view = lattice_view(frame, info.box, f.width);
  f.height =
      static_cast<int>(std::ceil(view.scale * (view.high - view.low) + kLatticeMargin + kLatticeLegend));
  const LatticeSymbols symbols = lattice_symbols(frame, info, cells, view);
  f.data = symbols.data;
  f.svg = lattice_svg(symbols, view, f.width, f.height);
  f.plot = lattice_plot(view, f.name);
  f.caption =
      "The last frame. Orientation A: close-packed rows within 10 degrees of the floor; B: of the side "
      "walls. Triangles and squares: five and seven neighbours by Voronoi cells; beads at walls, free "
      "surfaces and holes are not marked.";
  return f;
}

std::vector<Figure> spatial_figures(const std::vector<Result>& results, const TrajectorySource& trajectory,
                                    const AnalysisOptions& options) {
  const auto there = [&](const char* name) {
    return std::any_of(results.begin(), results.end(),
                       [&](const Result& r) { return r.name == name && r.present(); });
  };
  std::vector<Figure> figures;
  const TrajectoryInfo& info = trajectory.info();
  if (there("displacement_field") && there("field_x") && there("field_z"))
    figures.push_back(convection_figure(results, info.box));
  if (there("profile_z") && there("phi_z")) figures.push_back(profiles_figure(results));
  if (there("defect_fraction_j")) figures.push_back(defect_evolution_figure(results));
  if (info.box.dimension == 2 && there("coordination_beads")) {
    Frame last;
    trajectory.read(trajectory.n_frames() - 1, last);
    figures.push_back(lattice_figure(last, info, options));
  }
  return figures;
}

}  // namespace twincell::analysis
