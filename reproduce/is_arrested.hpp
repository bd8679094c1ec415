#pragma once
/// \file
/// Beds whose s_c passes sigma though they do not convect.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace twincell::reproduce {

/// Whether the tracers came to rest: s_j (Fortini & Huang 2015, eq. B1, in sigma, cycle by cycle) changed by
/// less than 0.1 sigma in the second half of the cycles. Where a bed convects its tracers keep changing
/// places, and s_j scatters by sigma and more; where it has rearranged once, s_j stays, and s_c with it.
/// Numbers that are not finite are passed over. \returns false for fewer than four cycles
inline bool is_arrested(const std::vector<double>& s_j) {
  constexpr double kStays = 0.1;
  constexpr std::size_t kLeast = 4;
  if (s_j.size() < kLeast) return false;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (std::size_t j = s_j.size() / 2; j < s_j.size(); ++j)
    if (std::isfinite(s_j[j])) least = std::min(least, s_j[j]), most = std::max(most, s_j[j]);
  return most >= least && most - least < kStays;
}

}  // namespace twincell::reproduce
