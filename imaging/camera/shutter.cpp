#include "imaging/camera/shutter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace twincell::imaging {

namespace {

// Fewest frames per period that can be interpolated without velocities. Beads in a stroboscopic stack of one
// frame per cycle would seem to stand still.
constexpr int kMinPhases = 8;

bool has(const Frame* frame, std::size_t slot) {
  return frame != nullptr && frame->present(slot) && std::isfinite(frame->position[slot].x());
}

template <class T>
T parabola(const T& before, double t_before, const T& now, const T& after, double t_after, double tau) {
  const T slope_before = (now - before) / -t_before, slope_after = (after - now) / t_after;
  const T curvature = (slope_after - slope_before) / (t_after - t_before);
  return now + tau * (slope_before + curvature * (tau - t_before));
}

}  // namespace

Shutter::Shutter(const TrajectoryInfo& info)
    : velocities_(info.columns.velocity),
      drive_(info.drive),
      phases_per_cycle_(info.phases_per_cycle),
      longest_gap_(info.drive ? info.drive->period() / kMinPhases * 1.000001
                              : std::numeric_limits<double>::infinity()) {}

void Shutter::require_paths(const TrajectoryInfo& info, const char* option) {
  if (!info.columns.velocity && info.phases_per_cycle > 0 && info.phases_per_cycle < kMinPhases)
    throw ConfigError(Where{.file = {}, .key = option},
                      fmt::format("needs the paths of beads, but the trajectory has no velocities and only "
                                  "{} frames per cycle; at least {} are needed.",
                                  info.phases_per_cycle, kMinPhases));
}

Vec3 Shutter::position(const Exposure& exposure, std::size_t slot, double tau) const {
  const Vec3& x = exposure.now->position[slot];
  if (tau == 0) return x;
  const Frame* neighbour = tau > 0 ? exposure.after : exposure.before;
  const double gap = has(neighbour, slot) ? neighbour->time - exposure.now->time : 0;
  const bool near = gap != 0 && std::abs(gap) <= longest_gap_;
  if (velocities_) {
    const Vec3& v = exposure.now->velocity[slot];
    if (!near) return x + tau * v;
    const double u = tau / gap;
    const Vec3 d = neighbour->position[slot] - x, p = gap * v, q = gap * neighbour->velocity[slot];
    return x + u * p + u * u * ((3 * d - 2 * p - q) + u * (p + q - 2 * d));
  }
  const bool before = has(exposure.before, slot), after = has(exposure.after, slot);
  if (before && after)
    return parabola<Vec3>(exposure.before->position[slot], exposure.before->time - exposure.now->time, x,
                          exposure.after->position[slot], exposure.after->time - exposure.now->time, tau);
  const Frame* one = after ? exposure.after : before ? exposure.before : nullptr;
  return one == nullptr ? x : Vec3(x + tau / (one->time - exposure.now->time) * (one->position[slot] - x));
}

double Shutter::plate(const Exposure& exposure, double tau) const {
  if (drive_ && phases_per_cycle_ > 0 && exposure.now->phase >= 0) {
    const double now = static_cast<double>(exposure.now->phase) / phases_per_cycle_,
                 turns = now + tau / drive_->period(), whole = std::floor(turns);
    return drive_->displacement(turns - whole,
                                drive_->cycle_at(exposure.now->time, now) + static_cast<std::int64_t>(whole));
  }
  const double z = exposure.now->plate_height;
  if (!std::isfinite(z)) return 0;
  const bool before = exposure.before != nullptr && std::isfinite(exposure.before->plate_height),
             after = exposure.after != nullptr && std::isfinite(exposure.after->plate_height);
  if (tau == 0 || !before || !after) return z;
  return parabola(exposure.before->plate_height, exposure.before->time - exposure.now->time, z,
                  exposure.after->plate_height, exposure.after->time - exposure.now->time, tau);
}

}  // namespace twincell::imaging
