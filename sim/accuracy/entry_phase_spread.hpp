#pragma once
/// \file
/// Statistics of an error over the entry phases of a collision.

#include <vector>

namespace twincell::sim {

/// Statistics of an error over the entry phases of a collision (the positions within a step at which the
/// contact begins).
struct EntryPhaseSpread {
  double mean = 0, rms = 0, largest = 0;  ///< `largest` is the largest modulus

  /// Statistics of the deviations of `values` from the exact value.
  static EntryPhaseSpread of(const std::vector<double>& values, double exact);
};

}  // namespace twincell::sim
