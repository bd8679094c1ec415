// Contacts for which a formula could divide by zero, or lose history or keep stale history.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.hpp"
#include "sim/laws/tangential/dashpot.hpp"
#include "sim/laws/tangential/force_clipped.hpp"
#include "sim/laws/tangential/spring.hpp"
#include "sim/laws/tangential/spring_limited.hpp"
#include "sim/run/make_solver.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/shaken_bed.hpp"

namespace twincell::sim::contact_test {
namespace {

constexpr SolverKind kKinds[] = {SolverKind::scalar, SolverKind::avx2, SolverKind::avx512,
                                 SolverKind::all_pairs};
const std::string kSpaceNoGravity =
    "[cell]\ndimension = 3\ndepth = 20.0\ngravity = 0.0\nheight = 100.0\nlid = \"wall\"\n";

bool finite(const System& s) {
  for (const Bead& b : s.beads)
    if (!std::isfinite(b.x + b.y + b.z + b.vx + b.vy + b.vz + b.spin + b.spin_x + b.spin_z)) return false;
  for (const Force& f : s.forces)
    if (!std::isfinite(f.x + f.y + f.z + f.q + f.q_x + f.q_z)) return false;
  return true;
}

TEST(Contact, CoincidentCentresStopByTheOverlapBound) {
  for (const auto& cell : {kNoGravity, kSpaceNoGravity})
    for (const SolverKind kind : kKinds) {
      if (!available(kind)) continue;
      Bench b(cell, 50, kind);
      b.add(5, 3, 0, 0), b.add(5, 3, 0, 0), b.add(9, 3, 0, 0);
      b.system.beads[0].y = b.system.beads[1].y = b.system.beads[2].y = b.scene.dimension == 3 ? 10 : 0;
      try {
        b.kernel->advance(b.system, 10);
        FAIL() << "two beads in one place were accepted";
      } catch (const RunError& e) {
        EXPECT_NE(std::string(e.what()).find("beads 0 and 1 overlap by 1 sigma"), std::string::npos)
            << e.what();
      }
      EXPECT_TRUE(finite(b.system));
    }
}

TEST(Contact, UnusedLanesDoNotAffectResults) {  // three beads in vectors of up to eight
  for (const SolverKind kind : kKinds) {
    if (!available(kind)) continue;
    Bench b("", 50, kind);
    for (int k = 0; k < 3; ++k) b.add(5 + 0.9999 * k, 0.5, 0.1 * k, 0);
    for (int k = 0; k < 100; ++k) {
      b.kernel->advance(b.system, 10);
      ASSERT_TRUE(finite(b.system));
      for (const ContactMemory& c : b.kernel->contacts())
        for (const double v : c.values) ASSERT_TRUE(std::isfinite(v));
    }
  }
}

TEST(Contact, NoTangentialForceWithoutTangentialVelocity) {
  for (const auto& cell : {kNoGravity, kSpaceNoGravity})
    for (const char* law : {"tangential = \"dashpot\"\ngamma_t = 100.0\n", "gamma_t = 100.0\n",
                            "tangential = \"spring-limited\"\ngamma_t = 100.0\n",
                            "tangential = \"force-clipped\"\ngamma_t = 100.0\n"}) {
      Bench b(cell + "[contact]\n" + law);
      b.add(9, 50, 1, 0), b.add(10.01, 50, -1, 0);
      for (Bead& bead : b.system.beads) bead.y = b.scene.dimension == 3 ? 10 : 0;
      b.advance_time(0.02);
      EXPECT_LT(b.system.beads[0].vx, -0.5);  // the beads have collided
      for (const Bead& bead : b.system.beads)
        EXPECT_EQ(std::abs(bead.spin) + std::abs(bead.spin_x) + std::abs(bead.spin_z) + std::abs(bead.vz) +
                      std::abs(bead.vy),
                  0)
            << law;
    }
}

template <class Law>
void expect_limits(const Law& law) {
  const PairScale wall{1, 0.5, 3};
  const auto c = law.constants(wall);
  const auto force = [&](double v, double f_n, double& xi) {
    Tangent<double, 1> x{{xi}};
    const double f = Law::force(c.data(), Tangent<double, 1>{{v}}, f_n, 1e-5, x).c[0];
    xi = x.c[0];
    return f;
  };
  for (const double v : {0.0, 0.5, -0.5, 1e300})
    for (const double stretch : {0.0, 1e-3, -1e-3}) {
      double xi = stretch;
      EXPECT_EQ(std::abs(force(v, 0, xi)), 0) << Law::kWord;
      EXPECT_TRUE(std::isfinite(xi)) << Law::kWord << " v " << v;
      double pulled = stretch;  // at the end of a contact the normal force is tensile: the limit is mu |F_n|
      const double f = force(v, -10, pulled);
      EXPECT_LE(std::abs(f), 0.6 * 10 * (1 + 1e-12)) << Law::kWord;
      EXPECT_TRUE(std::isfinite(f) && std::isfinite(pulled)) << Law::kWord;
    }
}

TEST(Contact, CoulombLimitAtZeroAndAttractiveNormalForce) {
  expect_limits(SpringSlider{1e4, {100, 0, 0}, 0.6});
  expect_limits(SpringLimitedSlider{{1e4, {100, 0, 0}, 0.6}});
  expect_limits(ForceClippedSlider{{1e4, {100, 0, 0}, 0.6}});
  expect_limits(DashpotSlider{{0, 50, 0}, 0.6});
  expect_limits(SpringSlider{0, {100, 0, 0}, 0.6});  // a spring of zero stiffness
  expect_limits(SpringSlider{0, {0, 0, 0}, 0.6});
  const auto c = SpringSlider{1e4, {100, 0, 0}, 0.6}.constants({1, 0.5, 3});
  Tangent<double, 1> xi{{1e-3}};
  SpringSlider::force(c.data(), Tangent<double, 1>{{0.5}}, 0.0, 1e-5, xi);
  EXPECT_DOUBLE_EQ(xi.c[0], -100 * 0.5 / 1e4);  // spring and dashpot together equal the limit, which is 0
  Tangent<double, 1> kept{{1e-3}};
  ForceClippedSlider::force(c.data(), Tangent<double, 1>{{0.5}}, 0.0, 1e-5, kept);
  EXPECT_DOUBLE_EQ(kept.c[0], 1e-3 + 0.5 * 1e-5);  // only the force is clipped
}

TEST(Contact, EveryContactBeginsWithoutHistory) {  // a bead that bounces along a rough floor, 1e6 steps
  Bench b("[cell]\nsides = \"periodic\"\n[contact]\ngamma_n = 0.0\ngamma_t = 0.0\n", 20.37);
  b.add(3, 0.502, 1, 0);
  int contacts = 0;
  bool before = false;
  for (int k = 0; k < 1'000'000; ++k) {
    const Bead at = b.system.beads[0];
    b.kernel->advance(b.system, 1);
    const Bead& now = b.system.beads[0];
    const auto held = b.kernel->contacts();
    const bool touching = now.z < 0.5;
    ASSERT_EQ(held.size(), touching ? 1U : 0U) << k;
    if (touching && !before) {
      ++contacts;
      ASSERT_LE(std::abs(held[0].values[0]),
                1.01 * b.system.dt * (std::abs(at.vx) + 0.5 * std::abs(at.spin)) + 1e-15)
          << k;
    }
    before = touching;
  }
  std::printf("%d contacts\n", contacts);
  EXPECT_GT(contacts, 300);
  EXPECT_TRUE(finite(b.system));
}

/// An oblique collision of a pair, one bead above the other, that moves along x at speed 1.
/// \param image offset added to the x of the second bead; a whole period must change nothing
System drifting_collision(double x, double image, std::int64_t rebuild_every) {
  // Soft springs reduce the effect of the last bit of a position.
  Bench b(
      "[cell]\ngravity = 0.0\nsides = \"periodic\"\nwidth = 4.0\nheight = 64.0\nlid = \"wall\"\n"
      "[contact]\nk_n = 1e4\nk_t = 1e2\n");
  b.kernel->rebuild_every(rebuild_every);
  b.add(x, 32, 1.25, 0.5), b.add(x + 0.25 + image, 33, 0.75, -0.5);
  b.advance_time(0.2);
  b.system.beads[1].x -= image;
  return b.system;
}

TEST(Contact, HistoryCrossesThePeriodicBoundary) {
  // The centres are 0.968 apart in z at first touch, after 0.032 t0. The contact lasts 0.022, and during it
  // the contact point passes x = 4.
  for (const std::int64_t rebuild_every : {0, 1, 7})
    for (const double image : {0.0, -4.0, 8.0}) {
      const System inside = drifting_collision(1.84, 0, rebuild_every),
                   across = drifting_collision(3.84, image, rebuild_every);
      EXPECT_GT(std::abs(inside.beads[0].spin), 1e-2);  // friction was active
      double worst = 0;
      for (std::size_t i = 0; i < 2; ++i) {
        const Bead &a = inside.beads[i], &b = across.beads[i];
        EXPECT_GT(b.x, 4);
        for (const double d : {a.x + 2 - b.x, a.z - b.z, a.vx - b.vx, a.vz - b.vz, 0.5 * (a.spin - b.spin)})
          worst = std::max(worst, std::abs(d));
      }
      std::printf("largest difference %.1e\n", worst);
      EXPECT_LE(worst, 1e-12);
    }
}

TEST(Contact, BeadInACornerIsInBalance) {
  // Soft springs: at k_n = 1e6 the last bit of a position changes the force by 1e-10.
  Bench b(
      "[cell]\ngravity = [-0.6, -0.8]\n[contact]\nk_n = 1e3\ngamma_n = 20.0\ngamma_t = 20.0\nk_t = 300.0\n");
  b.add(0.5, 0.5, 0, 0), b.add(1.5, 0.5, 0, 0), b.add(0.5, 1.5, 0, 0);
  b.advance_time(60);
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Force& f = b.system.forces[i];
    for (const double residue : {f.x - 0.6, f.z - 0.8, f.q}) worst = std::max(worst, std::abs(residue));
  }
  std::printf("largest residual force %.1e\n", worst);
  EXPECT_LE(worst, 1e-12);
  int walls = 0;  // wall contacts of the bead in the corner, each with its own history
  for (const ContactMemory& c : b.kernel->contacts()) walls += c.i == 0 && c.j < 0;
  EXPECT_EQ(walls, 2);
}

TEST(Contact, IndependentOfTheLabelsOfBeads) {
  ShakenBed as_drawn, relabelled;
  std::reverse(relabelled.system.beads.begin(), relabelled.system.beads.end());
  as_drawn.advance(12000), relabelled.advance(12000);
  std::reverse(relabelled.system.beads.begin(), relabelled.system.beads.end());
  double worst = 0;
  for (std::size_t i = 0; i < as_drawn.system.beads.size(); ++i) {
    const Bead &a = as_drawn.system.beads[i], &b = relabelled.system.beads[i];
    for (const double d : {a.x - b.x, a.z - b.z, a.vx - b.vx, a.vz - b.vz, a.spin - b.spin})
      worst = std::max(worst, std::abs(d));
  }
  std::printf("largest difference %.1e\n", worst);
  EXPECT_LE(worst, 1e-12);
}

TEST(Contact, LoneBeadFliesAParabola) {
  for (const SolverKind kind : kKinds) {
    if (!available(kind)) continue;
    Bench b("", 50.37, kind);
    b.add(10, 50, 0.3, 1);
    const int steps = 20000;
    b.kernel->advance(b.system, steps);
    const double t = b.system.time();
    EXPECT_NEAR(b.system.beads[0].x, 10 + 0.3 * t, 1e-13 * steps);
    EXPECT_NEAR(b.system.beads[0].z, 50 + t - t * t / 2, 1e-13 * steps);
    EXPECT_TRUE(b.kernel->contacts().empty());
  }
}

}  // namespace
}  // namespace twincell::sim::contact_test
