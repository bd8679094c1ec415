#include "analysis/motion/bed_phase.hpp"

#include <algorithm>
#include <cmath>

namespace twincell::analysis {

std::string phase_name(BedPhase phase) {
  return std::string(row_of(kBedPhases, phase).word);
}

std::string onset_name(BedPhase phase) {
  return phase == BedPhase::convecting ? "convection" : phase_name(phase);
}

BedPhase phase_named(const std::string& name) {
  const auto row =
      std::find_if(kBedPhases.begin(), kBedPhases.end(), [&](const auto& r) { return r.word == name; });
  return row == kBedPhases.end() ? BedPhase::undetermined : row->value;
}

BedPhase bed_phase(double s_b, double s_c) {
  if (std::isnan(s_b)) return BedPhase::undetermined;
  if (s_b <= kBouncingThreshold) return BedPhase::co_moving;
  if (std::isnan(s_c)) return BedPhase::undetermined;
  return s_c <= kConvectionThreshold ? BedPhase::bouncing : BedPhase::convecting;
}

}  // namespace twincell::analysis
