#include "trajectory/spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/cancellation.hpp"
#include "core/median.hpp"

namespace twincell {

double median_spacing(std::span<const Vec3> centres) {
  constexpr std::size_t kSampledCentres = 100;
  std::vector<Vec3> all;
  std::ranges::copy_if(centres, std::back_inserter(all), [](const Vec3& r) { return r.allFinite(); });
  if (all.size() < 2) return std::nan("");
  std::vector<double> nearest;
  const std::size_t stride = std::max<std::size_t>(1, all.size() / kSampledCentres);
  for (std::size_t i = 0; i < all.size(); i += stride) {
    double closest = HUGE_VAL;
    for (std::size_t j = 0; j < all.size(); ++j)
      if (j != i) closest = std::min(closest, (all[j] - all[i]).squaredNorm());
    nearest.push_back(std::sqrt(closest));
  }
  return upper_median(std::move(nearest));
}

std::size_t listed_again(std::span<const Vec3> centres, double distance) {
  // Beads sorted by the cell of a grid as wide as the distance: a neighbour lies in an adjacent cell.
  constexpr double kMaxCell = 1e15;  // cells; further out, neighbours cannot be distinguished
  struct InCell {
    std::array<std::int64_t, 3> cell;
    std::size_t bead;
  };
  std::vector<InCell> sorted;
  sorted.reserve(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const Vec3 r = centres[i] / distance;
    if (!r.allFinite() || r.cwiseAbs().maxCoeff() > kMaxCell) continue;
    const auto cell = [](double v) { return static_cast<std::int64_t>(std::floor(v)); };
    sorted.push_back({{cell(r.x()), cell(r.y()), cell(r.z())}, i});
  }
  std::ranges::sort(sorted, {}, &InCell::cell);
  const auto has_earlier = [&](const InCell& b) {
    throw_if_cancelled();
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        // Cells that differ in z alone follow each other.
        const std::array<std::int64_t, 3> from{b.cell[0] + dx, b.cell[1] + dy, b.cell[2] - 1};
        for (auto at = std::ranges::lower_bound(sorted, from, {}, &InCell::cell);
             at != sorted.end() && at->cell[0] == from[0] && at->cell[1] == from[1] &&
             at->cell[2] <= b.cell[2] + 1;
             ++at)
          if (at->bead < b.bead && (centres[at->bead] - centres[b.bead]).norm() < distance) return true;
      }
    return false;
  };
  return static_cast<std::size_t>(std::ranges::count_if(sorted, has_earlier));
}

}  // namespace twincell
