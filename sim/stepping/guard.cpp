#include "sim/stepping/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

std::string moment(const System& s) {
  return fmt::format("step {}, time {:.6g} t0", s.step, s.time());
}

double speed_of(const Bead& b) {
  return std::sqrt(b.vx * b.vx + b.vy * b.vy + b.vz * b.vz);
}

/// Likely cause of overlaps that are too deep or beads that are too fast, with the remedy.
std::string likely_cause(const System& s, const GuardLimits& limits) {
  return s.dt > limits.stable_step
             ? fmt::format(
                   "unstable step: {:.3g} t0 exceeds {:.3g}, the stability limit of a bed of beads in "
                   "contact; raise time.steps_per_contact",
                   s.dt, limits.stable_step)
             : "the beads are too fast or too heavy for their springs and the step: raise contact.k_n or "
               "time.steps_per_contact, or reduce the drive";
}

}  // namespace

GuardLimits guard_limits(const Plan& plan) {
  GuardLimits limits;
  limits.overlap = plan.overlap_bound;
  limits.travel_per_step = plan.travel_bound;
  // Verlet is stable for w dt < 2. A pair has w = pi/t_c. A bead held by six others in the hexagonal bed has
  // sqrt(3) times that; a bead held by twelve others in 3D has twice that.
  double shortest = HUGE_VAL;
  for (const TimeLimit& limit : plan.limits) shortest = std::min(shortest, limit.time);
  limits.stable_step = 2 / std::numbers::pi / (plan.dimension == 2 ? std::numbers::sqrt3 : 2) * shortest;
  return limits;
}

void explain_overlap(const System& s, const GuardLimits& limits) {
  check_motion(s, limits);  // a non-finite bead is a better explanation than its overlap
  double deepest = 0;
  std::string who = "none found";
  for_each_near_pair(s.beads, s.dimension, s.period, 0,
                     [&](std::int32_t i, std::int32_t j, double gap, const Vec3&) {
                       if (-gap > deepest) {
                         deepest = -gap;
                         who = fmt::format("beads {} and {}", i, j);
                       }
                     });
  for (const Wall& wall : s.walls) {
    const double offset = offset_now(s, wall);
    for (std::size_t i = 0; i < s.beads.size(); ++i) {
      const Bead& b = s.beads[i];
      const double overlap = b.radius - (wall.n.dot(Vec3(b.x, b.y, b.z)) - offset);
      if (overlap > deepest) {
        deepest = overlap;
        who = fmt::format("bead {} and the {}", i, wall.name == "bottom" ? "plate" : wall.name + " wall");
      }
    }
  }
  throw RunError(fmt::format("{}: {} overlap by {:.4g} sigma, the bound is {:g}; {}.", moment(s), who,
                             deepest, limits.overlap, likely_cause(s, limits)));
}

void check_motion(const System& s, const GuardLimits& limits) {
  const double plate = s.plate_height();
  for (std::size_t i = 0; i < s.beads.size(); ++i) {
    const Bead& b = s.beads[i];
    const double speed = speed_of(b);
    if (!std::isfinite(b.x + b.y + b.z + speed + b.spin + b.spin_x + b.spin_z))
      throw RunError(
          fmt::format("{}: bead {} has a non-finite position or speed; unstable step, raise "
                      "time.steps_per_contact.",
                      moment(s), i));
    if (speed * s.dt > limits.travel_per_step)
      throw RunError(fmt::format("{}: bead {} moves {:.3g} sigma in one step, the bound is {:g}; {}.",
                                 moment(s), i, speed * s.dt, limits.travel_per_step,
                                 likely_cause(s, limits)));
    if (limits.ceiling > 0 && b.z + b.radius > plate + limits.ceiling)
      throw RunError(
          fmt::format("{}: bead {} reached the height of the cell, {:g} sigma above the plate, where there "
                      "is no lid; raise cell.height, or set cell.lid = \"wall\".",
                      moment(s), i, limits.ceiling));
  }
}

}  // namespace twincell::sim
