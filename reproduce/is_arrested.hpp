#pragma once
/// \file
/// Test for arrested beds: s_c exceeds sigma although the bed does not convect.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace twincell::reproduce {

/// Whether the tracers came to rest: s_j (Fortini & Huang 2015, eq. B1, in sigma, cycle by cycle) changed by
/// less than 0.1 sigma in the second half of the cycles. In a convecting bed the tracers keep changing
/// places, and s_j fluctuates by sigma and more. In a bed that has rearranged once, s_j and therefore s_c
/// remain constant. Values that are not finite are skipped. \returns false for fewer than four cycles
inline bool is_arrested(const std::vector<double>& s_j) {
  constexpr double kMaxChange_sigma = 0.1;
  constexpr std::size_t kMinCycles = 4;
  if (s_j.size() < kMinCycles) return false;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (std::size_t j = s_j.size() / 2; j < s_j.size(); ++j)
    if (std::isfinite(s_j[j])) least = std::min(least, s_j[j]), most = std::max(most, s_j[j]);
  return most >= least && most - least < kMaxChange_sigma;
}

}  // namespace twincell::reproduce
