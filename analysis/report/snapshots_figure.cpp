#include "analysis/report/snapshots_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "analysis/report/phase_signs.hpp"
namespace twincell::analysis {
namespace {

using namespace colours;

struct StructureStyle {
  Structure structure;
  const char* colour;
  const char* name;
};
constexpr std::array<StructureStyle, 4> kStructures = {{{Structure::hexagonal, kGreen, "hexagonal"},
                                                        {Structure::square, kVermilion, "square"},
                                                        {Structure::other, kSand, "other"},
                                                        {Structure::undefined, kWhite, "under 2 bonds"}}};

/// Panels with the rows first and last, and the columns experiment and simulation. With one side only, one
/// row with first and last.
std::vector<BeadPanel> snapshot_panels(const Run* experiment, const Run* simulation) {
  std::vector<BeadPanel> panels;
  for (const bool last : {false, true})
    for (const Run* run : {experiment, simulation}) {
      if (run == nullptr) continue;
      const Snapshot& moment = last ? run->last : run->first;
      const std::string when = moment.frame.cycle >= 0 ? fmt::format("cycle {}", moment.frame.cycle)
                                                       : fmt::format("frame {}", moment.frame.step);
      panels.push_back({fmt::format("{}, {}", side_name(run->side), when), &moment, run->box, run->radius});
    }
  return panels;
}

/// Calls visit(x, z above the plate, radius, bead) for each bead of the panel.
template <class Visit>
void for_each_bead(const BeadPanel& p, const Visit& visit) {
  for (std::size_t i = 0; i < p.moment->frame.position.size(); ++i) {
    if (!p.moment->frame.present(i) || !p.moment->frame.position[i].allFinite()) continue;
    const Vec3 r = p.box.wrap(p.moment->frame.position[i]);
    visit(r.x(), r.z() - p.moment->plate, radius_of(p.radius, i), i);
  }
}

/// Layout of the panels on the sheet, in pixels at 100 %.
struct SnapshotSheet {
  PlotRange x, z;  ///< common to all panels, z above the plate
  std::size_t columns, rows;
  double scale = 1;  ///< pixels per sigma
  static constexpr double kWidth = 540, kMargin = 12, kTitle = 30, kLegend = 44;

  SnapshotSheet(const std::vector<BeadPanel>& panels, std::size_t columns_)
      : columns(columns_), rows((panels.size() + columns_ - 1) / columns_) {
    for (const BeadPanel& p : panels) {
      x.add(p.box.lower.x() - 0.3);
      x.add(p.box.upper.x() + 0.3);
      z.add(-0.6);
      z.add(2);
      for_each_bead(p,
                    [&](double, double height, double radius, std::size_t) { z.add(height + radius + 0.5); });
    }
    z.high =
        std::min(z.high, 3 * (x.high - x.low));  // one bead thrown high must not shrink the bed to a strip
    scale = (kWidth - kMargin * static_cast<double>(columns + 1)) / static_cast<double>(columns) /
            (x.high - x.low);
  }
  [[nodiscard]] double panel_width() const { return scale * (x.high - x.low); }
  [[nodiscard]] double panel_height() const { return scale * (z.high - z.low); }
  [[nodiscard]] double left(std::size_t panel) const {
    return kMargin + static_cast<double>(panel % columns) * (panel_width() + kMargin);
  }
  [[nodiscard]] double top(std::size_t panel) const {
    const std::size_t row = panel / columns;
    return kTitle + static_cast<double>(row) * (panel_height() + kTitle);
  }
  [[nodiscard]] double height() const {
    return static_cast<double>(rows) * (kTitle + panel_height()) + kLegend;
  }
};

/// The sheet as SVG with true circles. gnuplot would draw polygons with 72 corners, a file 50 times as large.
std::string snapshots_svg(const std::vector<BeadPanel>& panels, const SnapshotSheet& sheet) {
  const int height = static_cast<int>(std::ceil(sheet.height()));
  std::string svg = fmt::format(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 "
      "{0} {1}\" font-family=\"Arial, sans-serif\" font-size=\"15\">\n<rect width=\"{0}\" height=\"{1}\" "
      "fill=\"white\"/>\n",
      SnapshotSheet::kWidth, height);
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const BeadPanel& p = panels[n];
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                       sheet.left(n) + sheet.panel_width() / 2, sheet.top(n) - 9, p.title);
    svg += fmt::format(
        "<svg x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" viewBox=\"{:.3f} {:.3f} {:.3f} "
        "{:.3f}\">\n",
        sheet.left(n), sheet.top(n), sheet.panel_width(), sheet.panel_height(), sheet.x.low, -sheet.z.high,
        sheet.x.high - sheet.x.low, sheet.z.high - sheet.z.low);
    for (const StructureStyle& style : kStructures) {
      svg += fmt::format("<g fill=\"{}\" stroke=\"#333333\" stroke-width=\"0.04\">\n", style.colour);
      for_each_bead(p, [&](double x, double z, double radius, std::size_t i) {
        if (structure_of(p.moment->order, i) != style.structure) return;
        svg += fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.3g}\"/>\n", x, -z, radius);
      });
      svg += "</g>\n";
    }
    svg += fmt::format(
        "<path d=\"M{0:.3f} {1:.3f}V0H{2:.3f}V{1:.3f}\" fill=\"none\" stroke=\"#222222\" "
        "stroke-width=\"0.15\"/>\n</svg>\n",
        p.box.lower.x(), -sheet.z.high, p.box.upper.x());
  }
  double at = 20;
  for (const StructureStyle& style : kStructures) {
    svg += fmt::format(
        "<circle cx=\"{0}\" cy=\"{1}\" r=\"8\" fill=\"{2}\" stroke=\"#333333\"/><text x=\"{3}\" "
        "y=\"{4}\">{5}</text>\n",
        at, height - 20, style.colour, at + 14, height - 15, style.name);
    at += 128;
  }
  return svg + "</svg>\n";
}

/// The same sheet for gnuplot; fills `data`.
std::string snapshots_plot(const std::vector<BeadPanel>& panels, const SnapshotSheet& sheet,
                           const std::string& name, std::string& data) {
  const double height = std::ceil(sheet.height());
  std::string plot = fmt::format(
      "set multiplot\nset size ratio -1\nset xrange [{}:{}]\nset yrange [{}:{}]\nunset tics\nunset "
      "grid\nunset border\nunset key\n",
      sheet.x.low, sheet.x.high, sheet.z.low, sheet.z.high);
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const BeadPanel& p = panels[n];
    std::string block;
    for_each_bead(p, [&](double x, double z, double radius, std::size_t i) {
      const Structure s = structure_of(p.moment->order, i);
      const auto style = std::find_if(kStructures.begin(), kStructures.end(),
                                      [&](const StructureStyle& t) { return t.structure == s; });
      const double q6 = p.moment->order.q6[i];
      block += fmt::format("{:.5f} {:.5f} {:.4f} 0x{} {}\n", x, z, radius, style->colour + 1,
                           std::isnan(q6) ? "?" : fmt::format("{:.5f}", q6));
    });
    if (block.empty()) block = "? ? ? 0 ?\n";
    data += fmt::format("# {}: x, z above the plate, radius, colour, q6\n{}\n\n", gnuplot_plain_text(p.title),
                        block);
    plot += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset tmargin at screen {}\nset bmargin at screen "
        "{}\n",
        sheet.left(n) / SnapshotSheet::kWidth, (sheet.left(n) + sheet.panel_width()) / SnapshotSheet::kWidth,
        1 - sheet.top(n) / height, 1 - (sheet.top(n) + sheet.panel_height()) / height);
    plot += fmt::format(
        "set title '{0}' noenhanced offset 0,-0.6\n"
        "set arrow 1 from {1},0 to {1},{3} nohead front lw 2 lc rgb '#222222'\n"
        "set arrow 2 from {2},0 to {2},{3} nohead front lw 2 lc rgb '#222222'\n"
        "set arrow 3 from {1},0 to {2},0 nohead front lw 2 lc rgb '#222222'\n",
        gnuplot_plain_text(p.title), p.box.lower.x(), p.box.upper.x(), sheet.z.high);
    if (n + 1 == panels.size())
      for (std::size_t k = 0; k < kStructures.size(); ++k)
        plot += fmt::format("set label {} '{}' at screen {},{} point pt {} ps 1.8 lc rgb '{}' offset 1.2,0\n",
                            k + 1, kStructures[k].name, 0.04 + 0.235 * static_cast<double>(k), 20 / height,
                            kStructures[k].colour == kWhite ? 6 : 7,
                            kStructures[k].colour == kWhite ? "#333333" : kStructures[k].colour);
    plot += fmt::format(
        "plot '{}.dat' index {} using 1:2:3:4 with circles fs solid border lc rgb '#333333' lw 0.5 fc rgb "
        "variable notitle\n",
        name, n);
  }
  return plot + "unset multiplot\n";
}

}  // namespace

Figure beads_figure(const std::vector<BeadPanel>& panels, const std::string& name, const std::string& title,
                    std::size_t columns) {
  const SnapshotSheet sheet(panels, columns);
  Figure f;
  f.name = name;
  f.title = title;
  f.height = static_cast<int>(std::ceil(sheet.height()));
  f.svg = snapshots_svg(panels, sheet);
  f.plot = snapshots_plot(panels, sheet, name, f.data);
  f.caption =
      "Beads to scale, heights above the plate. Hexagonal: 6 neighbours and |q6 − 0.741| < 0.05; square: 4 "
      "neighbours and |q6 − 0.586| < 0.03.";
  return f;
}

Figure snapshots_figure(const std::vector<Run>& runs, const Match& match, const std::string& name) {
  const Run* experiment = match.experiments.empty() ? nullptr : &runs[match.experiments.front()];
  const Run* simulation = match.simulations.empty() ? nullptr : &runs[match.simulations.front()];
  Figure f = beads_figure(snapshot_panels(experiment, simulation), name,
                          fmt::format("Local order at Γ = {:.3g}", match.gamma), 2);
  f.caption += " First and last frame at phase 0. Neighbours are centres within ";
  f.caption +=
      experiment != nullptr && simulation != nullptr
          ? fmt::format("{} σ (experiment) and {} σ (simulation).", experiment->cutoff, simulation->cutoff)
          : fmt::format("{} σ.", (experiment != nullptr ? experiment : simulation)->cutoff);
  return f;
}

}  // namespace twincell::analysis
