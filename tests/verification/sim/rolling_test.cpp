// Rolling resistance against closed forms (docs/validation.md: V2.20).

#include <gtest/gtest.h>

#include <numbers>

#include "sim/contact/contact.hpp"
#include "sim/kernels/simd_scalar.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::rolling_test {
namespace {

using test::validate;

constexpr double kAngle = std::numbers::pi / 6;  // of the velocity against x

/// A bead that rests on the plate and rolls along x with speed 0.8; a sphere along kAngle, and twisting.
Bench rolling(int dimension, const std::string& contact) {
  const bool space = dimension == 3;
  Bench b(std::string(space ? "[cell]\ndimension = 3\nwidth = 20.0\ndepth = 20.0\n" : "") + "[contact]\n" +
          contact);
  const double v = 0.8;
  Bead& bead = b.add(5, 0.5 - 1e-6, v, 0, -v / 0.5);  // resting overlap m g/k_n
  if (space) {                                        // spin is that about -y
    bead.y = 5;
    bead.vx = v * std::cos(kAngle);
    bead.vy = v * std::sin(kAngle);
    bead.spin = -bead.vx / 0.5;
    bead.spin_x = -bead.vy / 0.5;
    bead.spin_z = 3;
  }
  return b;
}

// The torque mu_r R m g slows a bead that rolls without slip by mu_r g/(1 + I/(m R^2)).
TEST(Rolling, ResistanceSlowsABeadOnThePlate) {
  for (const auto& [dimension, share] : {std::pair{2, 0.5}, {3, 0.4}}) {
    Bench b = rolling(dimension, "mu = 0.6\nrolling = \"spring\"\nk_r = 1e4\nmu_r = 0.05\n");
    b.advance_time(4);
    const Bead& bead = b.system.beads[0];
    const std::string what = dimension == 3 ? "rolling sphere that twists: " : "rolling disc: ";
    const double v = std::hypot(bead.vx, bead.vy), rate = (0.8 - v) / b.system.time();
    validate({"V2.20", what + "deceleration over mu_r g", 1 / (1 + share), 1e-4, "closed form"}, rate / 0.05);
    if (dimension == 3) {
      validate({"V2.20", what + "change of its direction, rad", 0, 1e-9, "closed form"},
               std::atan2(bead.vy, bead.vx) - kAngle);
      validate({"V2.20", what + "twist over that at the start", 1, 1e-9, "closed form"}, bead.spin_z / 3);
    }
  }
}

// A spring within its limit: the angle rolled oscillates about 0 with omega^2 = k_r/(I + m R^2).
TEST(Rolling, SpringSwingsAboutTheFirstTouch) {
  for (const auto& [dimension, inertia] : {std::pair{2, 0.125}, {3, 0.1}}) {
    Bench b = rolling(dimension, "mu = 1e3\nrolling = \"spring\"\nk_r = 3.0\nmu_r = 1e3\n");
    const double omega = std::sqrt(3.0 / (inertia + 0.25));
    b.advance_time(2.25 * 2 * std::numbers::pi /
                   omega);  // two and a quarter periods: it rests for an instant
    const Bead& bead = b.system.beads[0];
    const std::string what = dimension == 3 ? "sphere" : "disc";
    const double away = std::hypot(bead.x - 5, dimension == 3 ? bead.y - 5 : 0);
    validate({"V2.20", what + " on a torsional spring: amplitude over v/omega", 1, 2e-3, "closed form"},
             away * omega / 0.8);
    validate({"V2.20", what + " on a torsional spring: speed at its end over v", 0, 1e-2, "closed form"},
             std::hypot(bead.vx, bead.vy) / 0.8);
  }
}

// Two spheres in contact that turn as one rigid body, n from z towards x: the angle rolled turns with them.
TEST(Rolling, SpringTurnsWithThePair) {
  using Laws = LawSet<LinearSpringDashpot, SpringSlider, RollingSpring>;
  constexpr Velocity kVelocity = Velocity::half_step;
  double c[Layout<Laws>::kCount] = {};
  c[constant::kInvRadiusI] = c[constant::kInvRadiusJ] = 2;
  c[Layout<Laws>::kNormal] = 1e5;
  c[Layout<Laws>::kRolling] = -30;      // -k_r
  c[Layout<Laws>::kRolling + 2] = 1e6;  // limit
  c[Layout<Laws>::kRolling + 3] = -1.0 / 30;
  double memory[kRemembered<Laws, kVelocity, 3>] = {};
  double* angle = memory + LinearSpringDashpot::kMemory + 3;
  angle[0] = 0.01;
  angle[1] = 0.02;
  for (int k = 1; k <= 10000; ++k) {
    const double turned = k * std::numbers::pi / 30000;
    ContactKinematics<double, 3> a{};
    a.n[0] = std::sin(turned);
    a.n[2] = std::cos(turned);
    a.overlap = 1e-4;
    (void)act<Laws, kVelocity, double, 3>(a, c, 1e-4, true, memory);
  }
  const double turned = std::numbers::pi / 3;
  // In 10000 turns of 0.006 degrees. Each projects and keeps the length, with an error of second order in it.
  validate({"V2.20", "angle rolled of a pair turned by 60 degrees: component in the plane, over that before",
            std::cos(turned), 1e-4, "rigid rotation"},
           angle[0] / 0.01);
  validate(
      {"V2.20", "angle rolled of a pair turned by 60 degrees: component along the axis, over that before", 1,
       1e-4, "rigid rotation"},
      angle[1] / 0.02);
  validate({"V2.20", "angle rolled of a pair turned by 60 degrees: component along the first normal",
            -std::sin(turned), 1e-4, "rigid rotation"},
           angle[2] / 0.01);
}

}  // namespace
}  // namespace twincell::sim::rolling_test
