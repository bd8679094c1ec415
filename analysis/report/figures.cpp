#include "analysis/report/figures.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "analysis/report/gnuplot_text.hpp"
#include "core/atomic_file.hpp"
#include "core/cancellation.hpp"

extern char** environ;

namespace twincell::analysis {
namespace {

using namespace colours;

constexpr std::array<BedPhase, 4> kPhases = {BedPhase::co_moving, BedPhase::bouncing, BedPhase::convecting,
                                             BedPhase::undetermined};
constexpr std::array<Side, 2> kSides = {Side::experiment, Side::simulation};

const char* phase_colour(BedPhase phase) {
  switch (phase) {
    case BedPhase::co_moving:
      return kBlue;
    case BedPhase::bouncing:
      return kOrange;
    case BedPhase::convecting:
      return kVermilion;
    case BedPhase::undetermined:
      break;
  }
  return kGrey;
}

/// gnuplot point type: circle, square, triangle, star; open for the experiment, filled for the simulation.
int phase_point(BedPhase phase, Side side) {
  const int filled = side == Side::simulation ? 1 : 0;
  switch (phase) {
    case BedPhase::co_moving:
      return 6 + filled;
    case BedPhase::bouncing:
      return 4 + filled;
    case BedPhase::convecting:
      return 8 + filled;
    case BedPhase::undetermined:
      break;
  }
  return 2 + filled;
}

std::string phase_key(const std::vector<Run>& runs) {
  std::string entries;
  for (const Side side : kSides)
    for (const BedPhase phase : kPhases)
      if (std::any_of(runs.begin(), runs.end(),
                      [&](const Run& r) { return r.phase == phase && r.side == side; }))
        entries +=
            fmt::format(", keyentry with points pt {} ps 1.5 lw 1.8 lc rgb '{}' title '{}, {}'",
                        phase_point(phase, side), phase_colour(phase), side_name(side), phase_name(phase));
  return entries;
}

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] Range padded(double share, double least) const {
    if (empty()) return {0, 1};
    const double pad = std::max(least, share * (high - low));
    return {low - pad, high + pad};
  }
};

/// Distance of tics that gives 4 to 10 tics on the range: 1, 2 or 5 times a power of ten.
double tic_step(const Range& range) {
  const double rough = std::max(1e-6, (range.high - range.low) / 8);
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  return decade * (rough <= decade ? 1 : rough <= 2 * decade ? 2 : rough <= 5 * decade ? 5 : 10);
}

Range gamma_range(const std::vector<Run>& runs) {
  Range range;
  for (const Run& run : runs) range.add(run.gamma);
  return range.padded(0.08, 0.1);
}

/// Appends to `data` one block for each phase and side, with the line `point(run)` for each run. Returns the
/// plot clauses that draw the blocks.
template <class Point>
std::string phase_blocks(const std::vector<Run>& runs, const std::string& name, std::string& data,
                         const Point& point) {
  std::string clauses;
  int index = 0;
  for (const Side side : kSides)
    for (const BedPhase phase : kPhases) {
      std::string block;
      for (const Run& run : runs)
        if (run.side == side && run.phase == phase) block += point(run);
      if (block.empty()) continue;
      data += fmt::format("# {}, {}\n{}\n\n", side_name(side), phase_name(phase), block);
      clauses += fmt::format(
          "{}'{}.dat' index {} using 1:2 with points pt {} ps 1.5 lw 1.8 lc rgb '{}' notitle",
          clauses.empty() ? "" : ", ", name, index++, phase_point(phase, side), phase_colour(phase));
    }
  return clauses;
}

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
  Range x, z;  ///< common to all panels, z above the plate
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

void run_gnuplot(const std::filesystem::path& folder, const std::string& script) {
  const std::string messages = (folder / (script + ".log")).string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, (script + ".log").c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_addclosefrom_np(&actions,
                                           3);  // gnuplot must not inherit files, locks and pipes
  std::string program = "gnuplot", argument = script;
  std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT)
    throw RunError("Figures are drawn by gnuplot, which is not installed (Debian: gnuplot-nox).");
  if (failure != 0) throw RunError(fmt::format("gnuplot could not be started: {}.", std::strerror(failure)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw RunError(fmt::format("Waiting for gnuplot failed: {}.", std::strerror(errno)));
    if (cancellation_requested() == 0 || finishing_first()) continue;
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    throw_if_cancelled();
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string words = read_text_file(messages);
    std::replace(words.begin(), words.end(), '\n', ' ');
    throw RunError(fmt::format("gnuplot failed on {}: {}", script, words.substr(0, 400)));
  }
  std::filesystem::remove(messages);
}

/// gnuplot does not tell that a disk is full or a file too large for its limit; the end of the picture does.
void require_whole(const std::filesystem::path& picture, const std::string& last_words) {
  constexpr std::streamoff kTail = 64;  // bytes
  std::ifstream stream(picture, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
  std::string tail(static_cast<std::size_t>(std::min(size, kTail)), '\0');
  stream.seekg(size - static_cast<std::streamoff>(tail.size()));
  stream.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find(last_words) == std::string::npos)
    throw RunError(
        fmt::format("{}: gnuplot did not finish the picture: no space is left, or files may not be as large.",
                    picture.string()));
}

}  // namespace

void draw(const Figure& figure, const std::filesystem::path& folder) {
  if (!is_figure_name(figure.name))
    throw RunError(
        fmt::format("A figure cannot be named '{}': letters, digits, '_', '-' and '.' only.", figure.name));
  const bool own_svg = !figure.svg.empty();
  std::string script = fmt::format("# {0}\n# gnuplot {1}.gp draws {2}\ndo for [kind in '{3}'] {{\n",
                                   gnuplot_plain_text(figure.title), figure.name,
                                   own_svg ? fmt::format("{0}.pdf and {0}.png", figure.name)
                                           : fmt::format("{0}.svg, {0}.pdf and {0}.png", figure.name),
                                   own_svg ? "pdf png" : "svg pdf png");
  for (const char* kind : {"svg", "pdf", "png"})
    if (!own_svg || kind != std::string_view("svg"))
      script += fmt::format("if (kind eq '{}') {{\n  {}}}\n", kind,
                            figure_style::terminal(kind, figure.width, figure.height));
  script += fmt::format("set output '{}.' . kind\n{}{}unset output\nreset\n}}\n", figure.name,
                        figure_style::head(), figure.plot);
  write_text_file(folder / (figure.name + ".dat"), figure.data);
  write_text_file(folder / (figure.name + ".gp"), script);
  if (own_svg) write_text_file(folder / (figure.name + ".svg"), figure.svg);
  run_gnuplot(folder, figure.name + ".gp");
  for (const auto& [kind, last_words] :
       {std::pair{"svg", "</svg>"}, std::pair{"pdf", "%%EOF"}, std::pair{"png", "IEND"}})
    require_whole(folder / fmt::format("{}.{}", figure.name, kind), last_words);
}

Figure phase_diagram_figure(const std::vector<Run>& runs) {
  Figure f{.name = "phase_diagram",
           .title = "Phase diagram",
           .caption = {},
           .width = 540,
           .height = 500,
           .plot = {},
           .data = {},
           .svg = {}};
  Range n_l;
  bool one_omega = true;
  for (const Run& run : runs) {
    n_l.add(run.n_l);
    one_omega = one_omega && std::abs(run.omega - runs.front().omega) <= 1e-3 * runs.front().omega;
  }
  const Range x = n_l.padded(0.12, 5);
  // Symbols of both sides at the same (N_l, Gamma) are drawn side by side, so that neither hides the other.
  const double aside = 0.014 * (x.high - x.low);
  const std::string clauses = phase_blocks(runs, f.name, f.data, [&](const Run& run) {
    return fmt::format("{} {} {} # {}\n", run.n_l + (run.side == Side::experiment ? -aside : aside),
                       run.gamma, run.k_m, gnuplot_plain_text(run.name));
  });
  const Range y = gamma_range(runs);
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
  f.plot +=
      "set key outside below center vertical maxrows 3 samplen 1 spacing 1.1 width -2 Left reverse\nplot " +
      clauses + phase_key(runs) + "\n";
  f.caption =
      "Phases of the bed over its number of layers and the strength of the drive. Open symbols: experiment "
      "(drawn a little to the left); filled: simulation (a little to the right).";
  if (!one_omega) f.caption += " The runs differ in ω, so there is no common K_m axis.";
  return f;
}

Figure phase_strip_figure(const std::vector<Run>& runs) {
  Figure f{.name = "phase_strip",
           .title = "Phases along the drive strength",
           .caption = {},
           .width = 540,
           .height = 300,
           .plot = {},
           .data = {},
           .svg = {}};
  const std::string clauses = phase_blocks(runs, f.name, f.data, [](const Run& run) {
    return fmt::format("{} {} # {}\n", run.gamma, run.side == Side::experiment ? 1 : 0,
                       gnuplot_plain_text(run.name));
  });
  const Range x = gamma_range(runs);
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

Figure thresholds_figure(const std::vector<Run>& runs) {
  Figure f{.name = "thresholds",
           .title = "s_b and s_c against the drive strength",
           .caption = {},
           .width = 540,
           .height = 740,
           .plot = {},
           .data = {},
           .svg = {}};
  static constexpr double kFloor = 1e-5;  // the logarithmic axes cannot show zero
  const Range x = gamma_range(runs);
  f.plot = fmt::format(
      "set multiplot layout 2,1\nset logscale y\nset format y '10^{{%T}}'\nset xrange [{}:{}]\nset xlabel 'Γ "
      "= A ω^2 / g'\nset lmargin 10\n",
      x.low, x.high);
  int index = 0;
  for (const char* name : {"s_b", "s_c"}) {
    const bool bounce = std::string(name) == "s_b";
    std::string clauses;
    Range y;
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
      "Values below 10⁻⁴ are drawn at 10⁻⁴.";
  return f;
}

Figure s_k_figure(const std::vector<Run>& runs) {
  Figure f{.name = "s_k",
           .title = "Height of the tracers above the plate through a cycle",
           .caption = {},
           .width = 540,
           .height = 740,
           .plot = {},
           .data = {},
           .svg = {}};
  Range y;
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
  const Range range = y.padded(0.05, 0.02);
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
  Figure f{.name = "s_j",
           .title = "Spread of the tracer line, cycle by cycle",
           .caption = {},
           .width = 540,
           .height = 740,
           .plot = {},
           .data = {},
           .svg = {}};
  Range y;
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
  const Range range = y.padded(0.05, 0.02);
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
