#include "trajectory/plate.hpp"

#include <cmath>

namespace twincell {

namespace {

std::optional<double> displacement_by_phase(const TrajectoryInfo& info, const Frame& frame) {
  if (!info.drive || info.phases_per_cycle <= 0 || frame.phase < 0) return std::nullopt;
  const double fraction = static_cast<double>(frame.phase) / info.phases_per_cycle;
  return info.drive->displacement(fraction, info.drive->cycle_at(frame.time, fraction));
}

bool driven_sideways(const TrajectoryInfo& info) {
  return info.drive && info.drive->axis != Axis::z;
}

}  // namespace

std::optional<double> plate_displacement(const TrajectoryInfo& info, const Frame& frame) {
  if (std::isfinite(frame.plate_height)) return frame.plate_height;
  return displacement_by_phase(info, frame);
}

std::optional<double> plate_height(const TrajectoryInfo& info, const Frame& frame) {
  if (driven_sideways(info)) return 0.0;
  return plate_displacement(info, frame);
}

Vec3 sideways_displacement(const TrajectoryInfo& info, const Frame& frame) {
  if (!driven_sideways(info)) return Vec3::Zero();
  return plate_displacement(info, frame).value_or(0) * Vec3::Unit(static_cast<int>(info.drive->axis));
}

bool plate_rests(const TrajectoryInfo& info, const Frame& frame) {
  if (driven_sideways(info) || frame.plate_height != 0) return false;
  // sin(pi) is not 0 to the last bit.
  constexpr double kMoved = 1e-9;
  return info.drive &&
         std::abs(displacement_by_phase(info, frame).value_or(0)) > kMoved * info.drive->displacement_bound();
}

}  // namespace twincell
