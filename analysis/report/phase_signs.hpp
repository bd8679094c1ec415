#pragma once
/// \file
/// How figures draw runs: colour and symbol of a phase, entries of the key, and ranges of axes.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/runs/phase_diagram.hpp"

namespace twincell::analysis {

/// The phases and sides in the order in which they are drawn.
inline constexpr std::array<BedPhase, 4> kPhases = {BedPhase::co_moving, BedPhase::bouncing,
                                                    BedPhase::convecting, BedPhase::undetermined};
inline constexpr std::array<Side, 2> kSides = {Side::experiment, Side::simulation};

/// Colour of a phase, "#RRGGBB".
const char* phase_colour(BedPhase phase);
/// gnuplot point type: circle, square, triangle, star; open for the experiment, filled for the simulation.
int phase_point(BedPhase phase, Side side);
/// Entries of the key for the phases of both sides that occur, each after a comma.
std::string phase_key(const std::vector<Run>& runs);

/// Range of an axis. Values that are not finite do not count.
struct PlotRange {
  double low = INFINITY, high = -INFINITY;
  /// Includes v, unless it is not finite.
  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  /// The range with a margin on both sides: `share` of its length, at least `least`.
  [[nodiscard]] PlotRange padded(double share, double least) const {
    if (empty()) return {0, 1};
    const double pad = std::max(least, share * (high - low));
    return {low - pad, high + pad};
  }
};

/// Distance of tics that gives 4 to 10 tics on the range: 1, 2 or 5 times a power of ten.
double tic_step(const PlotRange& range);
/// Range of the drive strengths of all runs, with a margin.
PlotRange gamma_range(const std::vector<Run>& runs);

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

}  // namespace twincell::analysis
