// Oblique impacts: Walton's diagram, and the eight cases of Chung & Ooi, Granular Matter 13, 643 (2011), for
// the linear law, whose closed forms are the reference (docs/validation.md: V2.7, V2.9).

#include <gtest/gtest.h>

#include <numbers>

#include "sim/laws/linear_collision.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::oblique_test {
namespace {

using test::validate;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

/// Motion after an impact on the plate at rest, with split steps.
struct Impact {
  double vx, vz, spin;
};
Impact on_plate(const std::string& law, double inertia_factor, double v_n, double v_x, double spin,
                double n = 200.37) {
  Bench b(kNoGravity + "[time]\nintegrator = \"split\"\n" + law, n);
  b.scene.inertia_factor = inertia_factor;
  const double gap = 5.3 * v_n * b.system.dt;
  b.add(10, 0.5 + gap, v_x, -v_n, spin);
  b.advance_time(8e-3 + 2 * gap / v_n);
  const Bead& a = b.system.beads[0];
  return {a.vx, a.vz, a.spin};
}
/// Tangential speed of the bead's surface at the plate.
double surface(double v_x, double spin) {
  return v_x + 0.5 * spin;
}

/// Elastic, k_t/k_n = 2/7: a sphere's tangential and normal springs oscillate at the same frequency, so
/// F_t/F_n keeps its value at first touch, 2/7 psi. Below psi = 3.5 mu beads stick and the surface velocity
/// is reversed; from psi = 7 mu on they slide throughout.
const std::string kWalton = "[contact]\ngamma_n = 0.0\ngamma_t = 0.0\nmu = 0.3\nk_t = 285714.2857142857\n";

TEST(ObliqueImpact, WaltonsPicture) {  // V2.7
  const auto after = [](double inertia_factor, double psi) {
    const Impact i = on_plate(kWalton, inertia_factor, 1, psi, 0);
    return surface(i.vx, i.spin);
  };
  for (const double psi : {0.25, 0.5, 0.9})
    validate(
        {"V2.7", "sphere on plate sticks: psi_2 at psi_1 = " + number(psi), -psi, 0.01 * psi, "closed form"},
        after(0.4, psi));
  for (const double psi : {2.5, 4.0})
    validate({"V2.7", "sphere on plate slides: psi_2 at psi_1 = " + number(psi), psi - 0.3 * 2 * 3.5, 0.01,
              "Walton & Braun 1986"},
             after(0.4, psi));
  validate({"V2.7", "slope of the sliding branch, sphere", 1, 0.01, "Walton & Braun 1986"},
           (after(0.4, 4.5) - after(0.4, 2.5)) / 2);
  validate({"V2.7", "slope of the sliding branch, disc", 1, 0.01, "Walton & Braun 1986"},
           (after(0.5, 4.5) - after(0.5, 2.5)) / 2);
  validate({"V2.7", "disc on plate slides: psi_2 at psi_1 = 4", 4 - 0.3 * 2 * 3, 0.01, "Walton & Braun 1986"},
           after(0.5, 4));
}

/// Maximum overlap and duration of a head-on impact, sampled step by step.
struct Course {
  double deepest = 0, time = 0;
};
Course course(bool pair, double v) {
  Bench b(kNoGravity + "[time]\nintegrator = \"split\"\n[contact]\ngamma_n = 0.0\ntangential = \"none\"\n",
          400.37);
  const double gap = 5.3 * v * b.system.dt;
  if (pair) {
    b.add(10 - 0.5 - gap / 2, 50, v / 2, 0);
    b.add(10 + 0.5 + gap / 2, 50, -v / 2, 0);
  } else {
    b.add(10, 0.5 + gap, 0, -v);
  }
  Course c;
  double entered = 0, left = 0, before = -gap;
  for (int k = 0; k < 800; ++k) {
    b.kernel->advance(b.system, 1);
    const auto& p = b.system.beads;
    const double overlap = pair ? 1 - (p[1].x - p[0].x) : 0.5 - p[0].z;
    c.deepest = std::max(c.deepest, overlap);
    if (before <= 0 && overlap > 0) entered = b.system.time() - overlap / v;
    if (before > 0 && overlap <= 0) left = b.system.time() + overlap / v;
    before = overlap;
  }
  c.time = left - entered;
  return c;
}

TEST(ChungAndOoi, HeadOn) {  // cases 1-3
  for (const bool pair : {true, false}) {
    const double m_eff = pair ? 0.5 : 1, w = std::sqrt(1e6 / m_eff);
    const std::string which = pair ? "case 1, two beads" : "case 2, bead on plate";
    for (const double v : {0.1, 2.0}) {
      const Course c = course(pair, v);
      validate({"V2.9", which + ", v = " + number(v) + ": deepest overlap over v/w0", 1, 1e-4, "closed form"},
               c.deepest * w / v);
      validate({"V2.9", which + ", v = " + number(v) + ": duration over pi/w0", 1, 1e-4, "closed form"},
               c.time * w / std::numbers::pi);
    }
  }
  for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0})
    validate(
        {"V2.9", "case 3, bead on plate: e where " + number(e) + " is asked", e, 1e-3, "closed form"},
        on_plate("[contact]\ntangential = \"none\"\nrestitution = " + std::to_string(e) + "\n", 0.4, 1, 0, 0)
            .vz);
}

TEST(ChungAndOoi, ObliqueOnPlateAtFixedSpeed) {  // case 4
  for (const double degrees : {10.0, 30.0, 40.0, 70.0, 80.0, 85.0}) {
    const double a = degrees * std::numbers::pi / 180, v_n = std::cos(a), v_t = std::sin(a);
    const Impact i = on_plate(kWalton, 0.4, v_n, v_t, 0);
    // Sticking reverses the surface velocity; in sliding the impulse is mu (1 + e) v_n. Spheres: 1/m_t = 3.5.
    const double psi = v_t / v_n;
    ASSERT_TRUE(psi < 3.5 * 0.3 || psi > 7 * 0.3);
    const double impulse = psi < 3.5 * 0.3 ? 2 * v_t / 3.5 : 0.3 * 2 * v_n;
    const std::string what = "case 4, sphere on plate at " + number(degrees) + " degrees: ";
    validate({"V2.9", what + "v_x", v_t - impulse, 2e-3, "closed form"}, i.vx);
    validate({"V2.9", what + "spin", -impulse * 0.5 / 0.1, 2e-3 * 5, "closed form"}, i.spin);
    validate({"V2.9", what + "v_z", v_n, 1e-3, "closed form"}, i.vz);
  }
}

TEST(ChungAndOoi, SpinOrSpeedOfTheSameSurface) {  // cases 5, 6
  for (const char* law : {"spring", "dashpot"}) {
    double worst = 0;
    for (const double speed : {0.2, 1.0, 3.0, 8.0}) {
      const std::string contact = std::string("[contact]\ntangential = \"") + law + "\"\nmu = 0.3\n";
      const Impact moving = on_plate(contact, 0.4, 1, speed, 0),
                   turning = on_plate(contact, 0.4, 1, 0, 2 * speed);
      worst =
          std::max({worst, std::abs((moving.vx - speed) - turning.vx),
                    std::abs(moving.spin - (turning.spin - 2 * speed)), std::abs(moving.vz - turning.vz)});
    }
    validate({"V2.9", std::string("cases 5 and 6, ") + law + ": impulses by speed and by spin differ by", 0,
              1e-10, "same surface velocity"},
             worst);
  }
}

TEST(ChungAndOoi, PairsThatSpin) {  // cases 7, 8
  const auto collide = [](double spin_1, double spin_2, double radius, double mass, const std::string& law) {
    Bench b(kNoGravity + law, 400.37);
    b.scene.inertia_factor = 0.4;
    const double gap = 5.3 * b.system.dt;
    b.add(10 - 0.5 - gap / 2, 50, 0.5, 0, spin_1);
    Bead& q = b.add(10 + radius + gap / 2, 50, -0.5, 0, spin_2);
    q.radius = radius, q.mass = mass, q.inertia = 0.4 * mass * radius * radius;
    b.advance_time(1.2e-2);
    return std::array{b.system.beads[0], b.system.beads[1]};
  };
  // Case 7: with opposite spins the surfaces roll on each other, so neither spins nor tangential velocities
  // change.
  const auto opposite = collide(3, -3, 0.5, 1, "");
  validate({"V2.9", "case 7, two beads with opposite spins: change of spin", 0, 1e-12, "symmetry"},
           std::max(std::abs(opposite[0].spin - 3), std::abs(opposite[1].spin + 3)));
  validate({"V2.9", "case 7: sideways speed", 0, 1e-12, "symmetry"},
           std::max(std::abs(opposite[0].vz), std::abs(opposite[1].vz)));
  validate({"V2.9", "case 7: e", 0.8948121, 0.25 / 400, "closed form"}, opposite[1].vx - opposite[0].vx);
  // Case 8: unequal beads, no slip, dashpot only: v_t falls by exp(-c_t t_c/(2 m_t) 2) and is shared by
  // impulse.
  const double radius = 0.8, mass = 3, spin_1 = 2, spin_2 = 1;
  const auto unequal = collide(spin_1, spin_2, radius, mass,
                               "[contact]\ntangential = \"dashpot\"\nmu = 1e9\nc_t = 40.0\nc_n = 50.0\n");
  const double m_eff = mass / (1 + mass), inverse = (1 + 1 / mass) * 3.5;
  const double t_c = LinearCollision(1e6, 50, m_eff).contact_time();
  const double slip = 0.5 * spin_1 + radius * spin_2;
  const double impulse = slip * (1 - std::exp(-40 * inverse * t_c)) / inverse;
  const double i_1 = 0.4 * 0.25, i_2 = 0.4 * mass * radius * radius;
  validate({"V2.9", "case 8, unequal spinning spheres: spin of the small one", spin_1 - 0.5 * impulse / i_1,
            1e-2, "closed form"},
           unequal[0].spin);
  validate({"V2.9", "case 8: spin of the large one", spin_2 - radius * impulse / i_2, 1e-2, "closed form"},
           unequal[1].spin);
  validate({"V2.9", "case 8: sideways momentum given over", impulse, 1e-3, "closed form"},
           std::abs(unequal[0].vz));
  validate({"V2.9", "case 8: momentum", 0, 1e-12, "conservation"},
           std::hypot(unequal[0].vx + mass * unequal[1].vx - (0.5 - 0.5 * mass),
                      unequal[0].vz + mass * unequal[1].vz));
}

}  // namespace
}  // namespace twincell::sim::oblique_test
