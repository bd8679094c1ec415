// One contact against its closed forms (docs/validation.md, V1 and V2).

#include <gtest/gtest.h>

#include <numbers>

#include "sim/laws/axes.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::one_contact_test {
namespace {

using test::validate;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

constexpr double kBeadBead = 0.8948121, kBeadWall = 0.8544679;  // e_n of the first paper, closed form

TEST(NormalContact, ClosedFormsOfTableOne) {
  const LinearCollision pair(1e6, 50, 0.5), wall(1e6, 100, 1);
  validate({"V1.2", "t_c of two beads, Table I", 2.222831e-3, 1e-9, "Fortini & Huang 2015, (A5)"},
           pair.contact_time());
  validate({"V1.3", "t_c of bead and wall, Table I", 3.145527e-3, 1e-9, "Fortini & Huang 2015, (A5)"},
           wall.contact_time());
  validate({"V1.2", "e_n of two beads, formula", 0.8948121, 1e-6, "closed form"}, pair.restitution());
  validate({"V1.3", "e_n of bead and wall, formula", 0.8544679, 1e-6, "closed form"}, wall.restitution());
}

TEST(NormalContact, ElasticPairKeepsItsSpeedToSecondOrder) {  // V1.1
  const std::string elastic = "[contact]\ngamma_n = 0.0\ntangential = \"none\"\n";
  for (const double n : {50.37, 100.37, 200.37}) {
    const auto e = over_entry_phases([&](double p) { return pair_restitution(elastic, n, 1, p); }, 1);
    validate({"V1.1", "elastic pair, largest error of e over entry phases, n = " + number(n), 0,
              1.2 / (n * n), "closed form"},
             e.largest);
    EXPECT_GE(e.largest,
              0.2 / (n * n));  // second order, and no better: a zero would mean that no collision occurred
  }
}

TEST(NormalContact, PairRestitution) {  // V1.2
  for (const double n : {20.37, 50.37, 200.37}) {
    const auto e = over_entry_phases([&](double p) { return pair_restitution("", n, 1, p); }, kBeadBead);
    const std::string at = " over entry phases, n = " + number(n);
    validate({"V1.2", "two beads, mean e" + at, kBeadBead, 3e-4, "closed form"}, kBeadBead + e.mean);
    validate({"V1.2", "two beads, largest error of e" + at, 0, 0.25 / n, "closed form"}, e.largest);
  }
}

TEST(NormalContact, WallRestitution) {  // V1.3
  for (const double n : {20.37, 50.37, 200.37}) {
    const auto e = over_entry_phases([&](double p) { return wall_restitution("", n, 1, p); }, kBeadWall);
    const double n_wall = n * 3.145527 / 2.222831;
    const std::string at = " over entry phases, n = " + number(n);
    validate({"V1.3", "bead and wall, mean e" + at, kBeadWall, 6e-4, "closed form"}, kBeadWall + e.mean);
    validate({"V1.3", "bead and wall, largest error of e" + at, 0, 0.35 / n_wall, "closed form"}, e.largest);
  }
}

TEST(NormalContact, DeepestOverlapAndThePullAtTheEnd) {  // V1.2, V1.4
  Bench b(kNoGravity, 400.37);
  const double gap = 5.4 * b.system.dt;
  b.add(10 - 0.5 - gap / 2, 50, 0.5, 0);
  b.add(10 + 0.5 + gap / 2, 50, -0.5, 0);
  double deepest = 0, entered = -1, pulled = -1;
  for (int k = 0; k < 1000; ++k) {
    b.kernel->advance(b.system, 1);
    const double overlap = 1 - (b.system.beads[1].x - b.system.beads[0].x);
    deepest = std::max(deepest, overlap);
    if (overlap > 0 && entered < 0) entered = b.system.time() - overlap / 1.0;  // speed 1 at entry
    if (overlap > 0 && entered > 0 && pulled < 0 && b.system.forces[0].x > 0)
      pulled = b.system.time() - entered;
  }
  validate({"V1.2", "two beads, deepest overlap at v = 1", 6.697e-4, 2e-6, "closed form"}, deepest);
  // F_n changes sign before the beads separate; the instant is resolved to about one step.
  validate({"V1.4", "two beads, moment of zero force over t_c", 0.977487, 3.0 / 400, "closed form"},
           pulled / 2.222831e-3);
}

TEST(NormalContact, ClippedAtZeroTension) {  // V1.5
  const std::string clipped = "[contact]\nnormal = \"linear-no-tension\"\n";
  const auto pair =
      over_entry_phases([&](double p) { return pair_restitution(clipped, 100.37, 1, p); }, 0.897054);
  const auto wall =
      over_entry_phases([&](double p) { return wall_restitution(clipped, 100.37, 1, p); }, 0.858758);
  validate({"V1.5", "two beads that never pull, mean e", 0.897054, 3e-4, "Schwager & Poschel 2007"},
           0.897054 + pair.mean);
  validate({"V1.5", "bead and wall that never pull, mean e", 0.858758, 6e-4, "Schwager & Poschel 2007"},
           0.858758 + wall.mean);
  for (const auto& [zeta, e] : {std::pair{1.0, 0.135335}, {2.0, 0.047769}}) {
    const std::string law = clipped + "gamma_n = " + std::to_string(zeta * 2 * std::sqrt(2e6)) + "\n";
    const auto strong =
        over_entry_phases([&](double p) { return pair_restitution(law, 200.37, 1, p); }, e, 20);
    validate({"V1.5", "two beads that never pull, zeta = " + number(zeta) + ", mean e", e, 3e-3,
              "Schwager & Poschel 2007"},
             e + strong.mean);
  }
}

TEST(NormalContact, RestitutionAskedIsRestitutionMeasured) {  // V1.6, V1.8: the wall needs its own c_n
  for (const double e : {0.99, 0.95, 0.9, 0.7, 0.5, 0.3, 0.1}) {
    const std::string asked = "[contact]\ntangential = \"none\"\nrestitution = " + std::to_string(e) + "\n";
    const double tolerance = e >= 0.5 ? 1e-3 : 5e-3;
    const auto pair =
        over_entry_phases([&](double p) { return pair_restitution(asked, 200.37, 1, p); }, e, 20);
    const auto wall =
        over_entry_phases([&](double p) { return wall_restitution(asked, 200.37, 1, p); }, e, 20);
    validate({"V1.6", "two beads, mean e where " + number(e) + " is asked", e, tolerance, "closed form"},
             e + pair.mean);
    validate({"V1.6", "bead and wall, mean e where " + number(e) + " is asked", e, tolerance, "closed form"},
             e + wall.mean);
  }
  // A single dashpot for both would give the wall 0.9282.
  const std::string second = "[contact]\ntangential = \"none\"\nrestitution = 0.9\n";
  validate(
      {"V1.8", "second paper's wall: e with its own c_n", 0.9, 1e-3, "Bhateja et al. 2016"},
      0.9 +
          over_entry_phases([&](double p) { return wall_restitution(second, 200.37, 1, p); }, 0.9, 20).mean);
  for (const char* k_n : {"1e5", "1e7"}) {
    const std::string law = second + "k_n = " + k_n + "\n";
    Bench time(kNoGravity + law, 200.37);  // its own step: t_c depends on the stiffness
    const double v = 0.05 / time.system.dt * 1e-3;
    validate(
        {"V1.6", std::string("two beads, mean e where 0.9 is asked, k_n = ") + k_n, 0.9, 1e-3, "closed form"},
        0.9 + over_entry_phases(
                  [&](double p) {
                    Bench b(kNoGravity + law, 200.37);
                    const double gap = (5 + p) * v * b.system.dt;
                    b.add(9.5 - gap / 2, 50, v / 2, 0);
                    b.add(10.5 + gap / 2, 50, -v / 2, 0);
                    b.kernel->advance(b.system, 300);
                    return (b.system.beads[1].vx - b.system.beads[0].vx) / v;
                  },
                  0.9, 20)
                  .mean);
  }
  // The law has no velocity scale: the same entry phase gives the same e.
  const auto at_origin = [&](double v) {  // where positions are rounded to at most 1e-16
    Bench b(kNoGravity + second, 50.37);
    b.system.walls.clear();
    const double gap = 5.3 * v * b.system.dt;
    b.add(-0.5 - gap / 2, 0, v / 2, 0);
    b.add(0.5 + gap / 2, 0, -v / 2, 0);
    b.advance_time(3e-3 + gap / v);
    return (b.system.beads[1].vx - b.system.beads[0].vx) / v;
  };
  const double slow = at_origin(1e-3);
  for (const double v : {0.1, 10.0})
    validate({"V1.6", "two beads, e at v = " + number(v) + " over e at 1e-3, same entry phase", 1, 1e-9,
              "closed form"},
             at_origin(v) / slow);
}

TEST(NormalContact, OverdampedContactsRun) {
  Bench b(kNoGravity + "[contact]\ngamma_n = 2830.0\n", 50.37);
  EXPECT_TRUE(std::isfinite(b.system.dt));
  EXPECT_GT(b.system.dt, 0);
  const double e = pair_restitution("[contact]\ngamma_n = 2830.0\n", 50.37, 1, 0.3);
  EXPECT_NEAR(e, 0, 0.05);
}

TEST(NormalContact, SameCollisionInAMovingFrame) {  // V1.9
  auto relative = [](double u, double w) {
    Bench b(kNoGravity, 50.37);
    b.add(9.49, 50, 0.5 + u, w);
    b.add(10.51, 50.3, -0.5 + u, w);
    b.advance_time(0.05);
    return std::array{b.system.beads[1].vx - b.system.beads[0].vx,
                      b.system.beads[1].vz - b.system.beads[0].vz, b.system.beads[0].spin};
  };
  const auto rest = relative(0, 0), moving = relative(3, -7);
  double worst = 0;
  for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(rest[k] - moving[k]));
  // Positions up to 50 are rounded to 7e-15; the spring multiplies this error by k_n t_c.
  validate({"V1.9", "rough collision in a frame moving at (3, -7)", 0, 1e-10, "Galilei"}, worst);
}

// A bead hits the plate at 45 degrees; returns v_t'/v_t of the surface.
double tangential_ratio_wall(const std::string& extra, double n, double phase) {
  Bench b(kNoGravity + extra, n);
  const double v = 1, gap = (5 + phase) * v * b.system.dt;
  b.add(10, 0.5 + gap, v, -v);
  b.advance_time(8e-3 + 2 * gap);
  const Bead& a = b.system.beads[0];
  // Surface velocity along t = (-1, 0) of the plate: v_t = -(v_x) - R spin.
  return (-a.vx - 0.5 * a.spin) / (-v);
}

double tangential_ratio_pair(const std::string& extra, double n, double phase, double inertia = 0.5) {
  Bench b(kNoGravity + extra, n);
  b.scene.inertia_factor = inertia;
  const double v = 1, slide = 0.01, gap = (5 + phase) * v * b.system.dt;
  b.add(10 - 0.5 - gap / 2, 50, v / 2, slide / 2);
  b.add(10 + 0.5 + gap / 2, 50, -v / 2, -slide / 2);
  b.advance_time(8e-3 + 2 * gap);
  const Bead &p = b.system.beads[0], &q = b.system.beads[1];
  // Along the tangent at first touch. That of the end of the run would have a share of the normal velocity,
  // by the angle through which the pair has turned, slide * time.
  return (-(p.vz - q.vz) - 0.5 * (p.spin + q.spin)) / (-slide);
}

TEST(TangentialContact, NoSlipFirstPaper) {  // V2.1, V2.2
  const std::string rough = "[contact]\nmu = 1e9\n";
  const auto wall =
      over_entry_phases([&](double p) { return tangential_ratio_wall(rough, 200.37, p); }, 0.310127, 20);
  const auto pair =
      over_entry_phases([&](double p) { return tangential_ratio_pair(rough, 200.37, p); }, 0.419530, 20);
  validate({"V2.1", "bead and wall without slip, first paper: v_t'/v_t", 0.310127, 3e-3, "closed form"},
           0.310127 + wall.mean);
  validate({"V2.2", "two beads without slip, first paper: v_t'/v_t", 0.419530, 3e-3, "closed form"},
           0.419530 + pair.mean);
}

TEST(TangentialContact, NoSlipSecondPaper) {  // V2.3: 0.9^7 for spheres, 0.9^6 for discs, wall and pair
  for (const auto& [inertia, exact] : {std::pair{"sphere", 0.478297}, {"disc", 0.531441}}) {
    const std::string law =
        "[contact]\nrestitution = 0.9\ntangential = \"dashpot\"\nc_t_over_c_n = 1.0\nmu = 1e9\n";
    auto measure = [&](double phase) {
      Bench b(kNoGravity + law, 200.37);
      b.scene.inertia_factor = std::string(inertia) == "sphere" ? 0.4 : 0.5;
      const double gap = (5 + phase) * b.system.dt;
      b.add(10, 0.5 + gap, 1, -1);
      b.advance_time(8e-3 + 2 * gap);
      return (-b.system.beads[0].vx - 0.5 * b.system.beads[0].spin) / (-1.0);
    };
    const auto e = over_entry_phases(measure, exact, 20);
    validate({"V2.3", std::string(inertia) + " on wall without slip, second paper: v_t'/v_t", exact, 2e-3,
              "closed form"},
             exact + e.mean);
    const double factor = std::string(inertia) == "sphere" ? 0.4 : 0.5;
    const auto pair = over_entry_phases(
        [&](double phase) { return tangential_ratio_pair(law, 200.37, phase, factor); }, exact, 20);
    validate({"V2.3", std::string("two ") + inertia + "s without slip, second paper: v_t'/v_t", exact, 2e-3,
              "closed form"},
             exact + pair.mean);
  }
}

TEST(TangentialContact, FullSlidingTakesThePullIntoAccount) {  // V2.4
  // Uses the slider alone. In the spring law the dashpot's share shortens the spring, so the force follows
  // the limit only at the rate k_t v_t.
  Bench b(kNoGravity + "[contact]\ntangential = \"dashpot\"\nmu = 0.01\ngamma_t = 1e4\n", 400.37);
  const double v_n = 0.5, v_t = 0.5 * std::sqrt(3.0), gap = 5.3 * v_n * b.system.dt;
  b.add(10, 0.5 + gap, v_t, -v_n);
  b.advance_time(1e-2 + 2 * gap / v_n);
  const double impulse = v_t - b.system.beads[0].vx;
  // Without the tensile force at the end it would be 1.854468.
  validate({"V2.4", "sliding impact: impulse over mu m v_n", 1.863048, 2e-3 * 1.863, "closed form"},
           impulse / (0.01 * v_n));
}

TEST(TangentialContact, SpinUpIdentity) {  // V2.5: I (spin' - spin) = m R (v_x' - v_x)
  for (const char* law : {"spring", "dashpot"}) {
    Bench b(kNoGravity + "[contact]\ntangential = \"" + law + "\"\nmu = 0.3\n", 50.37);
    b.add(10, 0.51, 0.8, -1, 0.4);
    b.advance_time(0.03);
    const Bead& a = b.system.beads[0];
    validate({"V2.5", std::string("spin-up on the floor, ") + law + ": I dspin - m R dv_x", 0, 1e-12,
              "closed form"},
             0.125 * (a.spin - 0.4) - 0.5 * (a.vx - 0.8));
    EXPECT_LT(a.spin, 0.4);  // a bead launched towards +x ends up rotating clockwise
  }
}

TEST(TangentialContact, SpinningBeadLeavesToTheLeft) {  // V2.15
  Bench b(kNoGravity, 50.37);
  b.add(10, 0.51, 0, -1, 5);
  b.advance_time(0.03);
  EXPECT_LT(b.system.beads[0].vx, 0);
  validate({"V2.15", "bead dropped with spin +5: sign of v_x", -1, 0, "convention of the first paper"},
           b.system.beads[0].vx < 0 ? -1 : 1);
  EXPECT_LT(b.system.beads[0].spin, 5);
  EXPECT_GT(b.system.beads[0].vz, 0);
}

// The reference is a program of first order at n = 2000; V2.16 compares with the exact solution.
TEST(TangentialContact, ObliqueImpactsOfAnIndependentProgram) {
  for (const auto& [degrees, vx, vz, spin] :
       {std::tuple{30.0, 0.38830, 0.74009, 0.44680}, {60.0, 0.77975, 0.42723, 0.34509}}) {
    const double angle = degrees * std::numbers::pi / 180;
    Bench b(kNoGravity, 2000.37);
    const double fall = std::cos(angle), gap = 5.5 * fall * b.system.dt;
    b.add(10, 0.5 + gap, std::sin(angle), -fall);
    b.advance_time(6e-3);
    const std::string what = "oblique impact at " + number(degrees) + " degrees, first paper: ";
    validate({"V2", what + "v_x", vx, 5e-4, "independent program"}, b.system.beads[0].vx);
    validate({"V2", what + "v_z", vz, 5e-4, "independent program"}, b.system.beads[0].vz);
    // The spin is four times the change of v_x, by the spin-up identity.
    validate({"V2", what + "|spin|", spin, 2e-3, "independent program"}, std::abs(b.system.beads[0].spin));
  }
}

TEST(TangentialContact,
     CoulombLimitAtZeroNormalForce) {  // finite, and the spring carries what the dashpot leaves
  using Scalar = Tangent<double, 1>;
  const PairScale wall{1, 0.5, 3};
  const auto spring = SpringSlider{1e4, {100, 0, 0}, 0.6}.constants(wall);
  Scalar xi{{1e-3}};
  EXPECT_EQ(std::abs(SpringSlider::force(spring.data(), Scalar{{0.5}}, 0.0, 1e-5, xi).c[0]), 0);
  EXPECT_DOUBLE_EQ(xi.c[0], -100 * 0.5 / 1e4);
  xi.c[0] = 2e-5;  // at rest the spring alone carries the force
  EXPECT_DOUBLE_EQ(SpringSlider::force(spring.data(), Scalar{{0}}, 10.0, 1e-5, xi).c[0], -0.2);
  const auto slider = DashpotSlider{{0, 50, 0}, 0.4}.constants(wall);
  Scalar none{{0}};
  EXPECT_EQ(std::abs(DashpotSlider::force(slider.data(), Scalar{{0}}, 10.0, 1e-5, none).c[0]), 0);
  EXPECT_EQ(DashpotSlider::force(slider.data(), Scalar{{1e9}}, 10.0, 1e-5, none).c[0], -4);
}

}  // namespace
}  // namespace twincell::sim::one_contact_test
