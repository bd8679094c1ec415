// Beads and blocks on an incline, and pairs of unlike beads (docs/validation.md: V1.7, V2.6, V2.8,
// V2.11-V2.13).

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "sim/laws/linear_collision.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::incline_test {
namespace {

using test::validate;
using test::validate_bound;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// A bead at rest on the plate of a cell tilted by `degrees`, with the static overlap of its weight.
Bench incline(const std::string& extra, double degrees) {
  Bench b(extra);
  b.system.gravity = Vec3(std::sin(radians(degrees)), 0, -std::cos(radians(degrees)));
  b.add(5, 0.5 + b.system.gravity.z() / 1e6, 0, 0);  // k_n of the preset
  return b;
}

/// The same for a block: a bead whose inertia prevents rotation.
Bench block(const std::string& extra, double degrees) {
  Bench b = incline(extra, degrees);
  b.system.beads[0].inertia = 1e15;
  return b;
}

/// Acceleration along the incline after the initial transient.
double acceleration(Bench& b) {
  b.advance_time(1);
  const double v = b.system.beads[0].vx, t = b.system.time();
  b.advance_time(1);
  return (b.system.beads[0].vx - v) / (b.system.time() - t);
}

TEST(Incline, DiscRollsOrSlides) {  // V2.11
  for (const double degrees : {10.0, 30.0, 50.0}) {
    Bench b = incline("", degrees);
    const double exact = 2.0 / 3 * std::sin(radians(degrees)), a = acceleration(b);
    validate({"V2.11", "disc rolls down " + number(degrees) + " degrees: a over (2/3) g sin", 1, 0.01,
              "closed form"},
             a / exact);
    EXPECT_NEAR(b.system.beads[0].vx, -0.5 * b.system.beads[0].spin, 1e-3 * b.system.beads[0].vx);
  }
  Bench steep = incline("[contact]\nmu = 0.1\n", 30);  // tan 30 = 0.577 > 3 mu
  const double exact = std::sin(radians(30)) - 0.1 * std::cos(radians(30)), a = acceleration(steep);
  validate(
      {"V2.11", "disc slides down 30 degrees, mu = 0.1: a over g (sin - mu cos)", 1, 0.01, "closed form"},
      a / exact);
}

TEST(Incline, SphereRolls) {  // V2.11
  Bench b = incline("", 30);
  b.system.beads[0].inertia = 0.1;
  validate({"V2.11", "sphere rolls down 30 degrees: a over (5/7) g sin", 1, 0.01, "closed form"},
           acceleration(b) / (5.0 / 7 * std::sin(radians(30))));
}

TEST(Incline, SpringHoldsABlock) {  // V2.12: displacement m g sin(theta)/k_t, no drift
  Bench gentle = block("", 10);
  gentle.advance_time(2);
  validate({"V2.12", "block held at 10 degrees: displacement over m g sin/k_t", 1, 1e-4, "closed form"},
           (gentle.system.beads[0].x - 5) / (std::sin(radians(10)) / 1e4));

  Bench near = block("", std::atan(0.95 * 0.6) * 180 / std::numbers::pi);
  near.advance_time(10);
  const double x = near.system.beads[0].x;
  near.kernel->advance(near.system, 1'000'000);
  validate({"V2.12", "block held at 0.95 of the threshold: drift over 1e6 steps", 0, 1e-9, "closed form"},
           near.system.beads[0].x - x);
}

TEST(Incline, BlockSlidesAboveTheFrictionAngle) {  // V2.12: threshold within 0.1 degree
  const double angle = std::atan(0.6) * 180 / std::numbers::pi;
  Bench below = block("", angle - 0.1), above = block("", angle + 0.1), steep = block("", 40);
  for (Bench* b : {&below, &above}) b->advance_time(10);
  validate({"V2.12", "block 0.1 degree below the friction angle: speed", 0, 1e-9, "closed form"},
           below.system.beads[0].vx);
  validate({"V2.12", "block 0.1 degree above it: a over g (sin - mu cos)", 1, 0.01, "closed form"},
           acceleration(above) / (std::sin(radians(0.1)) / std::cos(radians(angle))));
  validate({"V2.12", "block at 40 degrees: a over g (sin - mu cos)", 1, 0.01, "closed form"},
           acceleration(steep) / (std::sin(radians(40)) - 0.6 * std::cos(radians(40))));
}

TEST(Incline, DashpotLawCreeps) {  // V2.13: v = m g sin(theta)/c_t, never at rest
  for (const double degrees : {5.0, 20.0}) {
    Bench b = block("[contact]\ntangential = \"dashpot\"\nc_t = 100.0\n", degrees);
    b.advance_time(2);
    validate({"V2.13", "block creeps down " + number(degrees) + " degrees, second paper: v over m g sin/c_t",
              1, 0.01, "closed form"},
             b.system.beads[0].vx / (std::sin(radians(degrees)) / 100));
  }
}

TEST(UnlikeBeads, RestitutionAndMomentum) {  // V1.7: masses 1 : 1000, radii 0.5 : 5
  const double m_eff = 1000.0 / 1001;
  const double exact = LinearCollision(1e6, 100 * m_eff, m_eff).restitution();
  double worst_momentum = 0;
  const auto e = over_entry_phases(
      [&](double phase) {
        Bench b(kNoGravity + "[contact]\ntangential = \"none\"\n", 50.37);
        const double gap = (5 + phase) * b.system.dt;
        b.add(10 - 5 - 0.5 - gap, 50, 1, 0);
        Bead& large = b.add(10, 50, 0, 0);
        large.radius = 5;
        large.mass = 1000;
        large.inertia = 0.5 * 1000 * 25;
        b.advance_time(8e-3);
        const Bead &p = b.system.beads[0], &q = b.system.beads[1];
        worst_momentum = std::max(worst_momentum, std::abs(p.vx + 1000 * q.vx - 1));
        return q.vx - p.vx;
      },
      exact);
  validate({"V1.7", "masses 1 : 1000, mean e over entry phases", exact, 3e-4, "closed form"}, exact + e.mean);
  validate({"V1.7", "masses 1 : 1000, largest error of e", 0, 0.25 / 50.37 * 1.1, "closed form"}, e.largest);
  validate({"V1.7", "masses 1 : 1000, momentum", 0, 1e-12, "conservation"}, worst_momentum);
}

TEST(UnlikeBeads, AngularMomentumChangesOnlyByTheLeverArm) {  // V2.6: rate delta F_t, a property of the law
  Bench b(kNoGravity, 50.37);
  b.add(9.495, 50, 0.5, 0.5, 1);
  b.add(10.505, 50, -0.5, -0.5, 2);
  auto angular_momentum = [&] {
    double sum = 0;
    for (const Bead& p : b.system.beads) sum += p.x * p.vz - (p.z - 50) * p.vx + p.inertia * p.spin;
    return sum;
  };
  const double before = angular_momentum();
  double deepest = 0, strongest = 0;
  for (int k = 0; k < 600; ++k) {
    b.kernel->advance(b.system, 1);
    const Bead &p = b.system.beads[0], &q = b.system.beads[1];
    deepest = std::max(deepest, 1 - std::hypot(p.x - q.x, p.z - q.z));
    strongest = std::max(strongest, std::abs(b.system.forces[0].q));
  }
  const double drift = std::abs(angular_momentum() - before), bound = deepest * strongest * 2.222831e-3;
  ASSERT_GT(strongest, 0);
  validate_bound(
      {"V2.6", "angular momentum of a pair: change over delta_max F_t t_c", 0, 1, "lever arms R_i, R_j"},
      drift / bound);
  EXPECT_GT(drift, 1e-3 * bound);
}

TEST(TangentialContact, StiffSpringReversesTheSurface) {  // V2.8: k_t/k_n = m_t/m_eff
  for (const bool sphere : {false, true}) {
    const double ratio = sphere ? 2.0 / 7 : 1.0 / 3;
    Bench b(kNoGravity + "[contact]\nmu = 1e9\ngamma_n = 0.0\ngamma_t = 0.0\nk_t = " +
                std::to_string(1e6 * ratio) + "\n",
            200.37);
    b.add(10, 0.5 + 5.3 * b.system.dt, 1, -1);
    if (sphere) b.system.beads[0].inertia = 0.1;
    b.advance_time(6e-3);
    validate({"V2.8", std::string(sphere ? "sphere, k_t/k_n = 2/7" : "disc, k_t/k_n = 1/3") + ": v_t'/v_t",
              -1, 0.01, "closed form"},
             b.system.beads[0].vx + 0.5 * b.system.beads[0].spin);
  }
}

}  // namespace
}  // namespace twincell::sim::incline_test
