#include "imaging/refine/paler_discs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"

namespace twincell::imaging {

std::vector<Detection> paler_discs(const std::vector<Detection>& beads,
                                   const std::vector<Detection>& dropped) {
  constexpr double kRoom = 1.5;    // R
  constexpr double kAlike = 0.12;  // largest scatter of the darkness, relative
  std::vector<Detection> paler;
  for (const Detection& d : dropped) {
    if (d.verdict != Verdict::pale) continue;
    const auto near = [&](const Detection& o) { return std::hypot(o.x - d.x, o.y - d.y) < kRoom * d.radius; };
    if (std::none_of(beads.begin(), beads.end(), near) && std::none_of(paler.begin(), paler.end(), near))
      paler.push_back(d);
  }
  if (paler.empty()) return {};
  std::vector<double> darkness;
  for (const Detection& d : paler) darkness.push_back(d.darkness);
  const double typical = upper_median(darkness);
  if (robust_spread(std::move(darkness), typical) >= kAlike * typical) return {};
  return paler;
}

}  // namespace twincell::imaging
