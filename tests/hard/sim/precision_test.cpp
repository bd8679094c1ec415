// Contacts in single precision (VERIFICATION H28): a deep bed rests, collisions are those of double
// precision to a stated error, and what single precision cannot hold is refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/accuracy/work_precision.hpp"
#include "sim/contact/contact.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/start/start.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim {
namespace {

using test::validate;

std::string precision(bool single) {
  return std::string("time.precision=") + (single ? "single" : "double");
}

/// Eighty layers of the first paper's beads on a plate at rest, calm after 30 t0.
struct DeepBed {
  Scene scene;
  Plan plan;
  System system;
  std::unique_ptr<Solver> kernel;

  explicit DeepBed(bool single)
      : scene(read_scene_text("preset = \"fortini-huang-2015\"\n[cell]\nwidth = 4.0\n[beads]\ncount = 280\n"
                              "[drive]\namplitude = 0.0\n[contact]\ngamma_n = 400.0\ngamma_t = 400.0\n"
                              "[time]\nsteps_per_contact = 20\n",
                              "deep", {precision(single)})),
        plan(make_plan(scene)),
        system(make_system(scene, plan)),
        kernel(make_solver(plan, guard_limits(plan))) {
    system.beads = make_start(scene).beads;
    advance_time(30);
  }
  void advance_time(double time) {
    kernel->advance(system, static_cast<std::int64_t>(std::ceil(time / system.dt)));
  }
  /// Weight on the floor over N m g.
  [[nodiscard]] double carried() const {
    double force = 0;
    for (const Force& f : system.forces) force += f.z;
    return force / static_cast<double>(system.beads.size());
  }
};

TEST(Precision, H28_EightyLayersRest) {
  for (const bool single : {false, true}) {
    const std::string what = std::string("80 layers at rest, ") + (single ? "single" : "double");
    DeepBed bed(single);
    EXPECT_GE(std::max_element(bed.system.beads.begin(), bed.system.beads.end(),
                               [](const Bead& a, const Bead& b) { return a.z < b.z; })
                  ->z,
              80 * 0.86);
    const std::vector<Bead> before = bed.system.beads;
    bed.advance_time(30);
    double moved = 0;
    for (std::size_t k = 0; k < before.size(); ++k)
      moved = std::max({moved, std::abs(bed.system.beads[k].x - before[k].x),
                        std::abs(bed.system.beads[k].z - before[k].z)});
    validate({"H28", what + ": kinetic energy a bead, m g sigma", 0, 1e-10, "at rest"},
             kinetic_energy_per_bead(bed.system));
    validate({"H28", what + ": largest way of a bead in 30 t0, sigma", 0, 1e-9, "at rest"}, moved);
    validate({"H28", what + ": floor's force over N m g", 1, single ? 1e-6 : 1e-9, "closed form"},
             bed.carried());
  }
}

// Why places are not in single precision, and that the bound above can fail.
TEST(Precision, H28_PlacesInSinglePrecisionWouldNotRest) {
  DeepBed bed(true);
  double most = 0;
  for (int k = 0; k < 2000; ++k) {
    for (Bead& b : bed.system.beads) b.x = static_cast<float>(b.x), b.z = static_cast<float>(b.z);
    bed.kernel->advance(bed.system, 1);
    most = std::max(most, kinetic_energy_per_bead(bed.system));
  }
  std::printf("places rounded to single precision: up to %.1e m g sigma a bead\n", most);
  EXPECT_GT(most, 1e-10);
}

// Two beads pressed together by 80 m g, held by their spring, creep on by 1e-12 a step: less than the grain
// of single precision at the spring's length, 2e-10, in which it would not notice.
TEST(Precision, H28_ASlowCreepStretchesTheSpring) {
  const Plan plan = make_plan(read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 2\n[drive]\ngamma = 1.0\n", "creep"));
  std::vector<float> c;
  for (const double v : contact_constants(plan.bead, {.m_eff = 0.5, .r_eff = 0.25, .inv_m_t = 6}, 1, 2, 2))
    c.push_back(static_cast<float>(v));
  constexpr double kHeld = 4e-3, kWay = 1e-12;
  constexpr int kSteps = 100000;
  const float dt = 1e-4F;
  const ContactKinematics<float, 2> a{
      .n = {1, 0}, .overlap = 8e-5F, .v = {0, static_cast<float>(kWay / 1e-4)}, .s = {0}, .w = {0}};
  double xi = kHeld;
  for (int k = 0; k < kSteps; ++k)
    act<LawSet<LinearSpringDashpot, SpringSlider, NoRolling>, Velocity::half_step, float, 2>(a, c.data(), dt,
                                                                                             false, &xi);
  validate({"H28", "spring stretched by a slow creep, single: over the way gone", 1, 1e-6, "closed form"},
           (xi - kHeld) / (kWay * kSteps));
}

TEST(Precision, CollisionsErrByTheStatedAmount) {
  for (const double k_n : {1e5, 1e6, 1e7})
    for (const char* integrator : {"verlet", "split"}) {
      StepSetting setting{.integrator = integrator, .n = 50.37, .k_n = k_n};
      const CollisionErrors exact = collision_errors(setting);
      setting.single = true;
      const CollisionErrors single = collision_errors(setting);
      const double e = std::max(std::abs(single.restitution_pair.mean - exact.restitution_pair.mean),
                                std::abs(single.restitution_pair.largest - exact.restitution_pair.largest));
      const double oblique = std::max(std::abs(single.sticking_pair.mean - exact.sticking_pair.mean),
                                      std::abs(single.sticking_pair.largest - exact.sticking_pair.largest));
      std::printf("%s, k_n = %g: e of a pair changed by %.1e, v_t'/v_t by %.1e\n", integrator, k_n, e,
                  oblique);
      EXPECT_LE(e, 1e-7);
      EXPECT_LE(oblique, 3e-7);
      EXPECT_GT(e, 0);  // the contact was computed in single precision
    }
}

TEST(Precision, BedsAtRestErrByTheStatedAmount) {
  for (const double k_n : {1e5, 1e6, 1e7}) {
    const BedErrors e = bed_errors({.n = 20.37, .k_n = k_n, .single = true});
    std::printf("k_n = %g: overlaps err by %.1e, the floor's force by %.1e\n", k_n, e.overlap, e.floor_force);
    EXPECT_LE(e.overlap, 3e-7);
    EXPECT_LE(e.floor_force, 1e-6);
    EXPECT_LE(e.kinetic_energy, 1e-15);
  }
}

TEST(Precision, AGasIsAsHot) {  // to what the length of the runs leaves to chance
  const GasTemperature exact = gas_temperature({}, {}, 400),
                       single = gas_temperature({.single = true}, {}, 400);
  const double error = std::hypot(exact.standard_error, single.standard_error);
  std::printf("T_z of 40 beads, W = 20: %.3f +- %.3f (double), %.3f +- %.3f m V_p^2 (single)\n", exact.value,
              exact.standard_error, single.value, single.standard_error);
  EXPECT_NE(single.value, exact.value);
  EXPECT_NEAR(single.value, exact.value, 4 * error);
  EXPECT_LE(error, 0.05 * exact.value);
}

TEST(Precision, WhatItCannotHoldIsRefused) {
  const std::string scene = "[beads]\ncount = 10\n[drive]\nomega = 1.0\ngamma = 1.5\n[time]\nprecision = ";
  const auto planned = [&](const std::string& text, const std::vector<std::string>& set = {}) -> std::string {
    try {
      make_plan(read_scene_text(scene + text, "scene.toml", set));
      return "accepted";
    } catch (const ConfigError& e) {
      return e.what();
    }
  };
  EXPECT_EQ(planned("\"single\"\n"), "accepted");
  EXPECT_NE(
      planned("\"float\"\n").find("scene.toml:7:13: time.precision: 'float' is not one of double, single"),
      std::string::npos)
      << planned("\"float\"\n");
  for (const char* set : {"contact.overlap_bound=0.2", "beads.radius=1e-7", "beads.mass=1e-7"}) {
    const std::string said = planned("\"single\"\n", {set});
    EXPECT_NE(said.find("scene.toml:7:13: time.precision: \"single\" "), std::string::npos) << said;
    EXPECT_EQ(planned("\"double\"\n", {set}).find("precision"), std::string::npos) << set;
  }
}

}  // namespace
}  // namespace twincell::sim
