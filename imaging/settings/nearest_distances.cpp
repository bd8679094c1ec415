#include "imaging/settings/nearest_distances.hpp"

#include <algorithm>
#include <cmath>

namespace twincell::imaging {

std::vector<double> nearest_distances(const std::vector<Detection>& discs, std::size_t most) {
  if (discs.size() < 2) return {};
  const std::size_t stride = 1 + discs.size() / most;
  std::vector<double> nearest;
  for (std::size_t k = 0; k < discs.size(); k += stride) {
    double least = HUGE_VAL;
    for (const Detection& o : discs)
      if (&o != &discs[k]) least = std::min(least, std::hypot(o.x - discs[k].x, o.y - discs[k].y));
    nearest.push_back(least);
  }
  std::sort(nearest.begin(), nearest.end());
  return nearest;
}

}  // namespace twincell::imaging
