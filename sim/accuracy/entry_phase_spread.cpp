#include "sim/accuracy/entry_phase_spread.hpp"

#include <algorithm>
#include <cmath>

namespace twincell::sim {

EntryPhaseSpread EntryPhaseSpread::of(const std::vector<double>& values, double exact) {
  EntryPhaseSpread s;
  const double n = static_cast<double>(values.size());
  for (const double value : values) {
    const double error = value - exact;
    s.mean += error / n;
    s.rms += error * error / n;
    s.largest = std::max(s.largest, std::abs(error));
  }
  s.rms = std::sqrt(s.rms);
  return s;
}

}  // namespace twincell::sim
