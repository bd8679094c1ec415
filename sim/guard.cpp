#include "sim/guard.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/trajectory/error.hpp"
#include "sim/contact.hpp"
#include "sim/laws/side.hpp"

namespace twincell::sim {

namespace {
std::string moment(const System& s) {
  return fmt::format("step {}, time {:.6g} t0", s.step, s.time());
}
}  // namespace

void explain_overlap(const System& s, const GuardLimits& limits, double periodic_width) {
  check_motion(s, limits);  // a bead that is not finite explains more than its overlap
  double deepest = 0;
  std::string who = "none found";
  const PeriodicSides sides{periodic_width > 0 ? periodic_width : 1};
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    for (std::size_t j = i + 1; j < s.beads.size(); ++j) {
      const double dx = s.beads[i].x - s.beads[j].x;
      const double r =
          std::hypot(periodic_width > 0 ? sides.separation(dx) : dx, s.beads[i].z - s.beads[j].z);
      const double overlap = s.beads[i].radius + s.beads[j].radius - r;
      if (overlap > deepest) {
        deepest = overlap;
        who = fmt::format("beads {} and {}", i, j);
      }
    }
    const Walls walls(s);
    for (int w = 0; w < (periodic_width > 0 ? 1 : 3); ++w) {
      const double overlap = walls.of[w].overlap(s.beads[i]);
      if (overlap > deepest) {
        deepest = overlap;
        who = fmt::format("bead {} and the {}", i, w == Walls::kBottom ? "plate" : "side wall");
      }
    }
  }
  throw RunError(
      fmt::format("{}: {} overlap by {:.3g} sigma, the bound is {:g}; the step is too long for this speed or "
                  "the springs are too soft.",
                  moment(s), who, deepest, limits.overlap));
}

void check_motion(const System& s, const GuardLimits& limits) {
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    const Bead& b = s.beads[i];
    const double speed = std::hypot(b.vx, b.vz);
    if (!std::isfinite(b.x + b.z + speed + b.spin))
      throw RunError(
          fmt::format("{}: bead {} is no longer at a finite position or speed; the step is unstable, raise "
                      "time.steps_per_contact.",
                      moment(s), i));
    if (speed * s.dt > limits.travel_per_step)
      throw RunError(
          fmt::format("{}: bead {} moves {:.3g} sigma in one step, the bound is {:g}; the step is unstable "
                      "or the drive too fast.",
                      moment(s), i, speed * s.dt, limits.travel_per_step));
    if (limits.ceiling > 0 && b.z + b.radius > s.plate_height() + limits.ceiling)
      throw RunError(
          fmt::format("{}: bead {} touched the lid at {:g} sigma above the plate; raise cell.height.",
                      moment(s), i, limits.ceiling));
  }
}

}  // namespace twincell::sim
