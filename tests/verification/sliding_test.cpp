// Impacts that slide, with a tangential spring that remembers: the exact solution against closed forms and
// the limit of ever smaller steps, and the orders at which steps come to it (docs/validation.md: V2.16).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <tuple>

#include "sim/impacts.hpp"
#include "sim/kernel.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim {
namespace {

using test::validate;

std::string name(const Impact& i) {
  return fmt::format("{}, v_n {:.3g}, v_t {:.3g}, rim {:.3g}", i.wall ? "wall" : "pair", i.v_n, i.v_t, i.rim);
}

// --- the exact solution ---

TEST(Sliding, ConvergedValuesOfTheFirstPapersContact) {
  // Of steps with n = 20000 and first order, whose own error is some 3e-6 of the spin.
  const std::tuple<double, double, double> rows[] = {{45, 0.603046, 0.416243}, {60, 0.780520, 0.342021}};
  for (const auto& [degrees, v_t, spin] : rows) {
    const Outcome o = exact_outcomes({Impact::at(degrees, true)}, impact_scene()).front();
    const std::string what = fmt::format("bead on plate at {} degrees, Table I: ", degrees);
    validate({"V2.16", what + "v_t'", v_t, 2e-6, "n = 20000"}, o.v_t);
    validate({"V2.16", what + "w'", spin, 5e-6, "n = 20000"}, o.spin);
  }
}

TEST(Sliding, WithoutSlipItIsTheDampedOscillator) {
  for (const double degrees : {10.0, 45.0, 75.0}) {
    const Impact impact = Impact::at(degrees, true);
    const Outcome o = exact_outcomes({impact}, impact_scene("mu = 1e9\n")).front();
    const double t_c = LinearCollision(1e6, 100, 1).contact_time();
    validate({"V2.16", fmt::format("sticks at {} degrees: v_t'/v_t of the surfaces", degrees),
              sticking_ratio(1e4, 100, 3, t_c), 1e-9, "closed form"},
             (o.v_t - 0.5 * o.spin) / impact.v_t);
    validate({"V2.16", fmt::format("sticks at {} degrees: e", degrees),
              LinearCollision(1e6, 100, 1).restitution(), 1e-9, "closed form"},
             o.v_n / impact.v_n);
  }
}

TEST(Sliding, ElasticBeadsSlideThroughoutOrReverse) {
  // Walton & Braun 1986; a disc's springs swing at one rate where k_t/k_n = 1/3.
  const Scene scene = impact_scene("gamma_n = 0.0\ngamma_t = 0.0\nmu = 0.3\nk_t = 333333.3333333333\n");
  for (const double psi : {0.3, 0.8}) {
    const Outcome o = exact_outcomes({{true, 1, psi, 0}}, scene).front();
    validate({"V2.16", fmt::format("sticks, psi_1 = {}: psi_2", psi), -psi, 1e-9, "closed form"},
             o.v_t - 0.5 * o.spin);
  }
  for (const double psi : {2.5, 4.0}) {
    const Outcome o = exact_outcomes({{true, 1, psi, 0}}, scene).front();
    validate({"V2.16", fmt::format("slides, psi_1 = {}: psi_2", psi), psi - 0.3 * 2 * 3, 1e-9,
              "Walton & Braun 1986"},
             o.v_t - 0.5 * o.spin);
  }
}

/// A general collision of two beads in space by steps: v_i - v_j and R_i w_i + R_j w_j after it.
std::pair<Vec3, Vec3> by_steps(const RelativeMotion& touch, const std::string& keys, double n) {
  Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[cell]\ndimension = 3\nwidth = 40.0\ndepth = 40.0\nheight = 40.0\n"
      "lid = \"wall\"\ngravity = 0.0\n[beads]\ncount = 2\n[drive]\namplitude = 0.0\n[time]\n"
      "integrator = \"split\"\nstepping = \"steps\"\n[contact]\n" +
          keys,
      "sliding");
  scene.steps_per_contact = n;
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  s.dt = plan.shortest().time / n;
  const double back = 5.5 * s.dt, inertia = scene.inertia_factor * scene.mass * scene.radius * scene.radius;
  for (const double side : {0.5, -0.5}) {
    const Vec3 r = Vec3(20, 20, 20) + side * (touch.r - back * touch.u), v = side * touch.u;
    s.beads.push_back({.x = r.x(),
                       .z = r.z(),
                       .vx = v.x(),
                       .vz = v.z(),
                       .spin = -touch.s.y(),
                       .radius = scene.radius,
                       .mass = scene.mass,
                       .inertia = inertia,
                       .y = r.y(),
                       .vy = v.y(),
                       .spin_x = touch.s.x(),
                       .spin_z = touch.s.z()});
  }
  const auto kernel = make_kernel(plan, {});
  kernel->advance(s, static_cast<std::int64_t>(8 + 1.5 * n));
  const Bead &i = s.beads[0], &j = s.beads[1];
  return {Vec3(i.vx - j.vx, i.vy - j.vy, i.vz - j.vz),
          Vec3(0.5 * (i.spin_x + j.spin_x), -0.5 * (i.spin + j.spin), 0.5 * (i.spin_z + j.spin_z))};
}

TEST(Sliding, InSpaceItIsTheLimitOfEverSmallerSteps) {
  // Beads whose surfaces move across the plane in which the centres do, so that the force turns as it slides.
  const RelativeMotion touch{Vec3(0.6, 0, 0.8), Vec3(-1.4, 0.5, -0.9), Vec3(0.7, -0.4, 0.9)};
  for (const char* keys : {"", "mu = 0.2\nk_t = 285714.0\n", "slip = \"spring_only\"\n",
                           "slip = \"spring_only\"\nmu = 0.2\nk_t = 1e5\n"}) {
    const Scene scene = read_scene_text(
        std::string("preset = \"fortini-huang-2015\"\n[cell]\ndimension = 3\ndepth = 4.0\n[beads]\n"
                    "count = 1\n[drive]\namplitude = 0.0\n[contact]\n") +
            keys,
        "sliding");
    const Plan plan = make_plan(scene);
    EncounterSetting setting;
    setting.dimension = 3, setting.laws = &plan.bead, setting.pair = {0.5, 0.25, 7}, setting.turn = 5;
    ASSERT_NEAR(scene.inertia_factor, 0.4, 1e-15);
    const EncounterEnd end = meet_with_history(setting, touch, 0, 1, reading_of(plan.bead));
    ASSERT_TRUE(end.parted);
    const auto steps = by_steps(touch, keys, 20000.37);
    EXPECT_LT((steps.first - end.motion.u).norm(), 3e-6) << keys;
    EXPECT_LT((steps.second - end.motion.s).norm(), 6e-6) << keys;
    EXPECT_GT((end.motion.s - touch.s).norm(), 0.05) << "there is friction";
  }
}

TEST(Sliding, CutIntoFinerStepsTheExactSolutionIsTheSame) {
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 1\n[drive]\namplitude = 0.0\n", "sliding");
  const Plan plan = make_plan(scene);
  EncounterSetting setting;
  setting.laws = &plan.bead, setting.pair = {0.5, 0.25, 6}, setting.turn = 4;
  for (const SlipReading reading : {SlipReading::rescale, SlipReading::spring_only, SlipReading::clip})
    for (const double v_t : {-3.0, -0.7, 0.2, 0.9, 1.5, 4.0}) {
      const RelativeMotion touch{Vec3(0, 0, 1), Vec3(v_t, 0, -1), Vec3(0, 0.3, 0)};
      const EncounterEnd a = meet_with_history(setting, touch, 0, 1, reading),
                         b = meet_with_history(setting, touch, 0, 1, reading, 913);
      EXPECT_LT((a.motion.u - b.motion.u).norm() + (a.motion.s - b.motion.s).norm(), 5e-10) << v_t;
      EXPECT_NEAR(a.time / b.time, 1, 1e-10);
    }
}

TEST(Sliding, ReadingsOfTruncateAreDifferentLaws) {
  // Printed for docs/friction.md; that they differ, and where they must not.
  for (const double degrees : {10.0, 30.0, 45.0, 60.0, 75.0}) {
    double spin[3];
    for (const SlipReading r : {SlipReading::rescale, SlipReading::spring_only, SlipReading::clip}) {
      const Outcome o = exact_outcomes({Impact::at(degrees, true)}, impact_scene(), r).front();
      spin[static_cast<int>(r)] = o.spin;
      std::printf("READING|%g|%d|%.6f|%.6f\n", degrees, static_cast<int>(r), o.v_t, o.spin);
    }
    // Where everything slides, the spring-only and the clipped force are both mu F_n.
    if (degrees >= 60) {
      EXPECT_NEAR(spin[1], spin[2], 1e-9);
      EXPECT_GT(spin[1], 1.5 * spin[0]);
    }
    // From outside: at 60 degrees 0.760 against 0.342.
    if (degrees == 60) {
      EXPECT_NEAR(spin[1], 0.760, 5e-4);
      EXPECT_NEAR(spin[0], 0.342, 5e-4);
    }
  }
}

// --- orders ---

/// Angles from nearly head on to grazing, with and without spin that helps or hinders.
std::vector<Impact> impacts() {
  std::vector<Impact> all;
  for (const bool wall : {true, false})
    for (const double degrees : {10.0, 30.0, 45.0, 60.0, 75.0})
      for (const double rim : {0.0, -0.5, 1.0}) all.push_back(Impact::at(degrees, wall, 1, rim));
  return all;
}

struct Case {
  std::string what, keys;
  int dimension = 2;
};

TEST(Sliding, SplitIsOfSecondOrder) {
  constexpr double kCoarse = 50.37, kFine = 800.37;
  constexpr int kPhases = 16;
  const Case cases[] = {
      {"Table I", ""},
      {"Table I, spheres in space", "", 3},
      {"mu = 1", "mu = 1.0\n"},
      {"mu = 0.3, k_t/k_n = 2/7", "mu = 0.3\nk_t = 285714.2857142857\n"},
      {"mu = 0.3, k_t = k_n", "mu = 0.3\nk_t = 1e6\n"},
      {"gamma_n = 400", "gamma_n = 400.0\n"},
      {"gamma_n = 20, gamma_t = 400, k_t = 1e5", "gamma_n = 20.0\ngamma_t = 400.0\nk_t = 1e5\n"},
      {"no tension", "tension = \"clipped\"\n"},
      {"spring-only", "slip = \"spring_only\"\n"}};
  for (const Case& c : cases) {
    const auto errors = [&](double n) {
      return impact_errors(impacts(), impact_scene(c.keys, c.dimension), {.integrator = "split", .n = n},
                           kPhases);
    };
    const ImpactErrors coarse = errors(kCoarse), fine = errors(kFine);
    const auto order = [&](const PhaseSpread& a, const PhaseSpread& b) {
      return std::log(a.rms / b.rms) / std::log(kFine / kCoarse);
    };
    validate({"V2.16", c.what + ": order of the error of v_t'", 2, 0.1, "second order"},
             order(coarse.tangential, fine.tangential));
    validate({"V2.16", c.what + ": order of the error of w'", 2, 0.1, "second order"},
             order(coarse.spin, fine.spin));
    validate({"V2.16", c.what + ": error of R w' at n = 50.37, rms", 0, 2e-4, "exact solution"},
             coarse.spin.rms);
  }
}

TEST(Sliding, PairsThatTurnKeepARemnantOfFirstOrder) {
  // Beads turn about each other by v t_c/n within a step, and the normal of a step's end stands for all of
  // it.
  std::vector<Impact> pairs;
  for (const Impact& i : impacts())
    if (!i.wall) pairs.push_back(i);
  for (const double n : {400.37, 1600.37}) {
    const ImpactErrors e =
        impact_errors(pairs, impact_scene("mu = 0.1\n"), {.integrator = "split", .n = n}, 16);
    validate({"V2.16", fmt::format("mu = 0.1, pairs, n = {}: n times the error of R w'", n), 1e-4, 1e-4,
              "v t_c/sigma = 2e-3"},
             n * e.spin.rms);
  }
}

TEST(Sliding, VerletIsOfFirstOrder) {
  // Its friction is that of the first position inside the contact (docs/friction.md).
  const auto errors = [&](double n) {
    return impact_errors(impacts(), impact_scene(), {.integrator = "verlet", .n = n}, 16);
  };
  const ImpactErrors coarse = errors(200.37), fine = errors(1600.37);
  validate({"V2.16", "Table I, verlet: order of the error of w'", 1, 0.15, "first order"},
           std::log(coarse.spin.rms / fine.spin.rms) / std::log(8));
}

TEST(Sliding, SpringOnlyKeepsARemnantOfFirstOrder) {
  // Where sliding ends with surfaces that move back, the dashpot acts at once: the force itself jumps, by at
  // most mu |F_n|, somewhere within a step. Table I has no such jump.
  const auto errors = [&](double n) {
    return impact_errors(impacts(), impact_scene("slip = \"spring_only\"\nk_t = 285714.2857142857\n"),
                         {.integrator = "split", .n = n}, 16);
  };
  const ImpactErrors coarse = errors(50.37), fine = errors(800.37);
  validate({"V2.16", "spring-only, k_t/k_n = 2/7: order of the error of w'", 1, 0.15, "force that jumps"},
           std::log(coarse.spin.rms / fine.spin.rms) / std::log(800.37 / 50.37));
  validate(
      {"V2.16", "spring-only, k_t/k_n = 2/7: error of R w' at n = 50.37, rms", 0, 2e-3, "exact solution"},
      coarse.spin.rms);
}

TEST(Sliding, AtSixStepsAContactSpinIsRightToAHundredth) {
  for (const double degrees : {10.0, 30.0, 45.0, 60.0, 75.0}) {
    const std::vector<Impact> one{Impact::at(degrees, true)};
    const ImpactErrors e = impact_errors(one, impact_scene(), {.integrator = "split", .n = 6.37}, 64);
    validate({"V2.16", fmt::format("split, n = 6.37, {} degrees: mean error of w'", degrees), 0, 0.01,
              "exact solution"},
             e.spin.mean * 2);
    EXPECT_GT(e.spin.largest, 1e-5) << name(one.front());
  }
}

}  // namespace
}  // namespace twincell::sim
