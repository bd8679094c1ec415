#include "analysis/report/phase_signs.hpp"

#include <algorithm>

#include "analysis/report/colours.hpp"

namespace twincell::analysis {

const char* phase_colour(BedPhase phase) {
  switch (phase) {
    case BedPhase::co_moving:
      return colours::kBlue;
    case BedPhase::bouncing:
      return colours::kOrange;
    case BedPhase::convecting:
      return colours::kVermilion;
    case BedPhase::undetermined:
      break;
  }
  return colours::kGrey;
}

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

double tic_step(const PlotRange& range) {
  const double rough = std::max(1e-6, (range.high - range.low) / 8);
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  return decade * (rough <= decade ? 1 : rough <= 2 * decade ? 2 : rough <= 5 * decade ? 5 : 10);
}

PlotRange gamma_range(const std::vector<Run>& runs) {
  PlotRange range;
  for (const Run& run : runs) range.add(run.gamma);
  return range.padded(0.08, 0.1);
}

}  // namespace twincell::analysis
