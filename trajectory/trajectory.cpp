#include "trajectory/trajectory.hpp"

#include <algorithm>

namespace twincell {

double gravity_of(const TrajectoryInfo& info) {
  if (!info.drive) return 1;
  const bool none = info.conditions.n_l && !info.conditions.gamma && !info.drive->ramp;
  return none ? 0 : info.drive->gravity;
}

std::size_t Frame::n_present() const {
  if (id.empty()) return position.size();
  return static_cast<std::size_t>(std::count_if(id.begin(), id.end(), [](std::int64_t v) { return v >= 0; }));
}

}  // namespace twincell
