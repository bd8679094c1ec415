#include "analysis/report/boundary_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "analysis/report/gnuplot_text.hpp"

namespace twincell::analysis {
namespace {

/// Symbols of a phase: a small sign for points, a colour of the palette.
struct PhaseSign {
  BedPhase phase;
  int symbol;
  const char* colour;
};
constexpr PhaseSign kSigns[] = {{BedPhase::co_moving, 2, "grey"},
                                {BedPhase::bouncing, 1, "blue"},
                                {BedPhase::convecting, 3, "vermilion"}};

struct Limits {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  /// Widened by a share of the range, at least by `least`.
  void pad(double share, double least) {
    const double by = std::max(share * (high - low), least);
    low -= by;
    high += by;
  }
};

/// A data block and the clause that plots it.
class Blocks {
 public:
  explicit Blocks(std::string file) : file_(std::move(file)) {}
  void add(const std::string& rows, const std::string& columns, const std::string& style) {
    data += (count_ > 0 ? "\n\n" : "") + rows;
    clauses +=
        fmt::format("{}'{}.dat' index {} using {} {}", count_ > 0 ? ", " : "", file_, count_, columns, style);
    ++count_;
  }
  std::string data, clauses;

 private:
  std::string file_;
  int count_ = 0;
};

const char* colour_of(BedPhase onset) {
  return onset == BedPhase::bouncing ? "blue" : "vermilion";
}

void add_points(Blocks& blocks, const Comparison& c) {
  constexpr std::size_t kMaxLargePoints = 200;  // points of a sweep that are drawn large
  const double size = c.sweep.size() > kMaxLargePoints ? 0.6 : 1.2;
  for (const PhaseSign& sign : kSigns) {
    std::string rows;
    for (const SweepPoint& p : c.sweep)
      if (p.phase == sign.phase) rows += fmt::format("{} {}\n", p.n_l, p.gamma);
    if (!rows.empty())
      blocks.add(rows, "1:2",
                 fmt::format("with points pt {} ps {} lc rgb {} title '{}: run of a sweep'", sign.symbol,
                             size, sign.colour, phase_name(sign.phase)));
  }
}

void add_onsets(Blocks& blocks, const Comparison& c, double aside) {
  struct Group {
    std::string whole, lower, upper;  ///< rows: onsets with a value, lower limits, upper limits
    int symbol = 7;
    bool filled = true;
    BedPhase onset = BedPhase::bouncing;
    bool sweep = false;
  };
  std::map<std::string, Group> groups;
  for (const PhaseBoundary& b : c.boundaries) {
    Group& g = groups[fmt::format("{}: {}", onset_name(b.onset), boundary_of(b))];
    g.onset = b.onset;
    g.sweep = b.sweep;
    constexpr int kOpenCircle = 6, kCircle = 7, kSquare = 5;
    g.symbol = b.sweep ? kSquare : b.side == Side::experiment ? kOpenCircle : kCircle;
    // Onsets of several sides at one N_l are drawn side by side.
    const double x = b.n_l + (b.sweep ? 0 : b.side == Side::experiment ? -aside : aside);
    g.filled = b.side != Side::experiment;
    if (b.gamma())
      g.whole += fmt::format("{} {} {} {}\n", x, *b.gamma(), b.below.value_or(*b.gamma()),
                             b.above.value_or(*b.gamma()));
    else if (b.below)
      g.lower += fmt::format("{} {}\n", x, *b.below);
    else if (b.above)
      g.upper += fmt::format("{} {}\n", x, *b.above);
  }
  for (const auto& [name, g] : groups) {
    const std::string title = fmt::format("'{}' noenhanced", gnuplot_plain_text(name));
    if (!g.whole.empty()) {
      if (g.sweep && std::count(g.whole.begin(), g.whole.end(), '\n') > 1)
        blocks.add(g.whole, "1:2", fmt::format("with lines lc rgb {} notitle", colour_of(g.onset)));
      blocks.add(g.whole, "1:2:3:4",
                 fmt::format("with yerrorbars pt {} ps 1.3 lw 1.5 lc rgb {} title {}", g.symbol,
                             colour_of(g.onset), title));
    }
    constexpr int kUp = 8, kDown = 10;  // the filled symbol is the next one
    bool named = !g.whole.empty();
    for (const auto& [rows, symbol] : {std::pair(&g.lower, kUp), std::pair(&g.upper, kDown)})
      if (!rows->empty()) {
        blocks.add(*rows, "1:2",
                   fmt::format("with points pt {} ps 1.5 lc rgb {} {} {}", symbol + (g.filled ? 1 : 0),
                               colour_of(g.onset), named ? "notitle" : "title", named ? "" : title));
        named = true;
      }
  }
}

}  // namespace

Figure boundary_figure(const Comparison& c) {
  Figure f{.name = "boundaries", .title = "Phase boundaries", .width = 580, .height = 560};
  Limits x, y;
  for (const SweepPoint& p : c.sweep) {
    x.add(p.n_l);
    y.add(p.gamma);
  }
  for (const PhaseBoundary& b : c.boundaries) {
    x.add(b.n_l);
    for (const auto& end : {b.below, b.above, b.fitted})
      if (end) y.add(*end);
  }
  x.pad(0.12, 1);
  y.pad(0.1, 0.1);
  Blocks blocks(f.name);
  add_points(blocks, c);
  constexpr double kAside = 0.03;
  add_onsets(blocks, c, kAside * (x.high - x.low));
  f.data = blocks.data;
  f.plot = fmt::format(
      "set xlabel 'N_l σ'\nset ylabel 'Γ = A ω^2 / g'\nset xrange [{}:{}]\nset yrange [{}:{}]\n"
      "set key outside below center vertical maxrows 5 samplen 1 spacing 1.1 width -2 Left reverse\nplot "
      "{}\n",
      x.low, x.high, y.low, y.high, blocks.clauses);
  f.caption =
      "Onsets of bouncing and of convection over the number of layers, with their intervals. Open circle: "
      "experiment (drawn a little to the left); filled circle: simulation (a little to the right); square: "
      "fitted by a sweep, whose single runs are the small signs. A triangle that points up marks a lower "
      "limit, one that points down an upper limit.";
  return f;
}

}  // namespace twincell::analysis
