#include "trajectory/wrapped_positions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twincell {

void PositionExtent::add(const Vec3& position) {
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(position[k])) continue;
    least_[k] = std::min(least_[k], position[k]);
    most_[k] = std::max(most_[k], position[k]);
  }
}

bool PositionExtent::is_wrapped(int axis, double period, double sigma) const {
  constexpr double kOutside = 1;  // sigma, on either side
  return period > 0 && most_[axis] - least_[axis] <= period + 2 * kOutside * sigma;
}

PeriodCounter::PeriodCounter(const Vec3& period, std::size_t n_beads)
    : period_(period),
      last_(n_beads, Vec3::Constant(std::numeric_limits<double>::quiet_NaN())),
      counts_(n_beads, Vec3::Zero()) {}

const Vec3& PeriodCounter::next(std::size_t bead, const Vec3& position) {
  Vec3& last = last_[bead];
  for (int k = 0; k < 3; ++k) {
    if (!(period_[k] > 0) || !std::isfinite(position[k])) continue;
    if (std::isfinite(last[k])) counts_[bead][k] -= std::round((position[k] - last[k]) / period_[k]);
    last[k] = position[k];
  }
  return counts_[bead];
}

Vec3 PeriodCounter::unwrapped(std::size_t bead, const Vec3& position) {
  return moved(position, next(bead, position), period_);
}

Vec3 PeriodCounter::moved(Vec3 r, const Vec3& m, const Vec3& period) {
  for (int k = 0; k < 3; ++k)
    if (m[k] != 0) r[k] += m[k] * period[k];
  return r;
}

}  // namespace twincell
