// Time steps that are too long, too short or too many, and the clock.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/error.hpp"
#include "sim/laws/cell_laws.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::sim::time_step_test {
namespace {

const std::string kGood = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = 1.5\n";

Scene good(const std::vector<std::string>& set) {
  return read_scene_text(kGood, "scene.toml", set);
}
Plan plan_of(const std::vector<std::string>& set) {
  return make_plan(good(set));
}
bool has_warning(const Plan& plan, const std::string& wanted) {
  for (const std::string& w : plan.warnings)
    if (w.find(wanted) != std::string::npos) return true;
  return false;
}

TEST(TimeStep, CoarseStepsGiveAWarningOrAreRefused) {
  EXPECT_TRUE(plan_of({"time.steps_per_contact=20"}).warnings.empty());
  EXPECT_TRUE(has_warning(plan_of({"time.steps_per_contact=19"}), "time.steps_per_contact = 19 is below 20"));
  expect_refusal<ConfigError>([] { good({"time.steps_per_contact=5"}); },
                              "time.steps_per_contact: 5 is out of range; the value must be at least 6");
  EXPECT_NO_THROW(plan_of({"time.steps_per_contact=5", "time.allow_unstable_step=true"}));
}

// A linear normal law has a stiffness of its own: Mindlin's spring, whose stiffness 2 Y sqrt(R delta)/((2 -
// nu) (1 + nu)) belongs to another one, can be far stiffer. Half its period at the overlap of an elastic
// impact, delta = v sqrt(m_eff/k_n), limits the step.
TEST(TimeStep, OfMindlinsSpringWithALinearNormalLaw) {
  const std::vector<std::string> set = {"contact.tangential=mindlin", "contact.k_n=1e5",
                                        "contact.youngs_modulus=1e8", "contact.poisson_ratio=0.3"};
  const auto limit_of = [](const Plan& plan) -> std::optional<double> {
    for (const TimeLimit& limit : plan.limits)
      if (limit.name == "bead-bead, tangential contact") return limit.time;
    return std::nullopt;
  };
  const Scene scene = good(set);
  const Plan plan = make_plan(scene);
  // Discs of mass 1 and radius 1/2: m_eff = 1/2, R_eff = 1/4, 1/m_t = 2 (1 + m R^2/I) = 6. Beads meet at
  // twice the largest speed of the plate, or at sqrt(2 g sigma).
  const double v = std::max(2 * scene.drive.velocity_bound(), std::sqrt(2.0));
  const double overlap = v * std::sqrt(0.5 / 1e5), k_t = 2e8 * std::sqrt(0.25 * overlap) / (1.7 * 1.3);
  ASSERT_TRUE(limit_of(plan));
  EXPECT_NEAR(*limit_of(plan) / (std::numbers::pi / std::sqrt(6 * k_t)), 1, 1e-12);
  EXPECT_NEAR(plan.dt * scene.steps_per_contact / plan.shortest().time, 1, 1e-2);
  EXPECT_LE(plan.shortest().time, *limit_of(plan));
  EXPECT_FALSE(
      limit_of(plan_of({"contact.normal=hertz", "contact.tangential=mindlin", "contact.youngs_modulus=1e8"})))
      << "Hertz's stiffness grows alike";
}

TEST(TimeStep, DefaultIsWrittenToResolvedScene) {
  const struct {
    std::vector<std::string> set;
    const char* integrator;
    double n;
    bool stated;
  } cases[] = {{{}, "split", 20, false},
               {{"time.steps_per_contact=33"}, "split", 33, false},
               {{"time.integrator=split"}, "split", 20, true},
               {{"time.integrator=verlet"}, "verlet", 50, true},  // LAMMPS's step, as before
               {{"time.integrator=predicted"}, "predicted", 50, true},
               {{"time.integrator=verlet", "time.steps_per_contact=8"}, "verlet", 8, true},
               {{"contact.tangential=none", "contact.mu=0"}, "split", 20, false},
               {{"contact.normal=hertz", "contact.youngs_modulus=1e7"}, "split", 20, false}};
  for (const auto& c : cases) {
    const Scene s = good(c.set), again = read_scene_text(s.resolved, "again");
    EXPECT_EQ(s.integrator, c.integrator);
    EXPECT_EQ(s.steps_per_contact, c.n);
    EXPECT_EQ(s.integrator_stated, c.stated);
    // The stored scene fixes the step, whatever defaults a later program has.
    EXPECT_TRUE(again.integrator_stated);
    EXPECT_EQ(again.integrator, c.integrator);
    EXPECT_EQ(again.steps_per_contact, c.n);
    EXPECT_EQ(again.resolved, s.resolved);
  }
  // A scene that states both is stored as by earlier programs, so the point names and the seeds derived from
  // it stay the same.
  const std::string whole =
      "[beads]\ncount = 3\n[drive]\ngamma = 1.0\nomega = 1.0\n[time]\nintegrator = \"split\"\n";
  EXPECT_EQ(read_scene_text(whole + "steps_per_contact = 20\n", "s").resolved,
            read_scene_text(whole, "s").resolved);
  const auto stated_of = [](const Plan& plan) {
    return std::find_if(plan.effects.begin(), plan.effects.end(), [](const Effect& e) {
             return e.name == kTimeIntegration;
           })->reason.find("the default") == std::string::npos;
  };
  EXPECT_FALSE(stated_of(plan_of({})));
  EXPECT_TRUE(stated_of(plan_of({"time.integrator=split"})));
}

/// Settles a crystal at steps of dt/t_c = 1/n.
RelaxationResult rest(const char* n) {
  return Simulation(good({"beads.count=100", "cell.width=10", "time.allow_unstable_step=true",
                          "start.settle_limit=20", std::string("time.steps_per_contact=") + n}))
      .settled();
}

TEST(TimeStep, CrystalRestsOrTheStepIsReportedUnstable) {
  for (const char* n : {"20", "10", "5"}) EXPECT_TRUE(rest(n).reached) << n;
  for (const char* n : {"2", "1.5", "1"})
    expect_refusal<RunError>([&] { rest(n); }, "unstable step: ", "raise time.steps_per_contact");
}

TEST(TimeStep, FastestRateSetsTheStep) {
  const double usual = plan_of({}).dt;
  const struct {
    std::vector<std::string> set;
    const char* limit;
    double time;  // for equal discs of mass 1: 1/m_t = 6, at a wall 3
  } cases[] = {
      {{"contact.gamma_t=1e5"}, "bead-bead, tangential contact", 2 / (6 * 1e5 * 0.5)},
      {{"contact.k_t=1e9"}, "bead-bead, tangential contact", std::numbers::pi / std::sqrt(6e9)},
      {{"contact.tangential=dashpot", "contact.c_t=1e6"}, "bead-bead, tangential contact", 2 / 6e6},
      {{"contact.wall.gamma_t=1e6"}, "bead-bottom, tangential contact", 2 / (3 * 1e6)},
      {{"contact.gamma_n=1e6"}, "bead-bead, normal contact", 1 / (1e6 / 2)},
      {{"cell.plate_drag=1e6"}, "plate drag", 1e-6},
      {{"contact.sides.k_n=1e10"}, "bead-left, normal contact", std::numbers::pi / 1e5},
  };
  for (const auto& c : cases) {
    const Plan plan = plan_of(c.set);
    const TimeLimit* limit = nullptr;
    double shortest = HUGE_VAL;
    for (const TimeLimit& l : plan.limits) {
      if (l.name == c.limit) limit = &l;
      shortest = std::min(shortest, l.time);
    }
    ASSERT_NE(limit, nullptr) << c.limit;
    EXPECT_NEAR(limit->time, c.time, 1e-3 * c.time) << c.set[0];
    EXPECT_EQ(shortest, limit->time) << c.set[0];
    EXPECT_LT(plan.dt, usual / 10) << c.set[0];
    EXPECT_LE(plan.dt, limit->time / 20) << c.set[0];
    EXPECT_GE(plan.dt, limit->time / 21) << c.set[0];
  }
}

TEST(TimeStep, StiffSpringsKeepTheirRestitution) {
  const std::string stiff = "[contact]\nk_n = 1e9\n";
  const Bench bench(kNoGravity + stiff);
  const double asked = std::get<LinearSpringDashpot>(bench.plan.laws->bead.normal)
                           .oscillator({.m_eff = 0.5, .r_eff = 0.25, .inv_m_t = 6})
                           .restitution();
  const PhaseErrors errors =
      over_entry_phases([&](double phase) { return pair_restitution(stiff, 50.37, 1, phase); }, asked, 20);
  std::printf("e = %.6f, error %.1e on average, %.1e at most\n", asked, errors.mean, errors.largest);
  EXPECT_LE(std::abs(errors.mean), 1e-3);
  EXPECT_LE(errors.largest, 5e-3);
  EXPECT_TRUE(has_warning(plan_of({"contact.k_n=1e9", "time.steps_per_contact=50"}), "a cycle takes 4.4"));
}

TEST(TimeStep, OverdampedContactsHaveAFiniteStep) {
  for (const char* gamma : {"2828.0", "2830.0", "1e5"}) {
    const Plan plan = plan_of({std::string("contact.gamma_n=") + gamma});
    EXPECT_TRUE(std::isfinite(plan.dt) && plan.dt > 0) << gamma;
    const auto collision = std::get<LinearSpringDashpot>(plan.laws->bead.normal)
                               .oscillator({.m_eff = 0.5, .r_eff = 0.25, .inv_m_t = 6});
    EXPECT_EQ(collision.restitution() == 0, collision.damping_ratio() >= 1) << gamma;
    const double e = pair_restitution(std::string("[contact]\ngamma_n = ") + gamma + "\n", 50.37, 1, 0.3);
    EXPECT_LT(std::abs(e), 0.02) << gamma;
  }
}

TEST(TimeStep, ZeroRestitutionIsRefusedAndCriticalDampingSuggested) {
  expect_refusal<ConfigError>([] { plan_of({"contact.restitution=0"}); },
                              "contact.restitution: 0 is out of range", "gamma_n = 2 sqrt(k_n/m_eff)");
}

TEST(TimeStep, RestitutionOneIsAcceptedAndMoreRefused) {
  EXPECT_EQ(
      std::get<LinearSpringDashpot>(plan_of({"contact.restitution=1"}).laws->bead.normal).damping.eta(0.5),
      0);
  for (const char* e : {"1.0000001", "-0.5", "nan", "inf"})
    expect_refusal<ConfigError>([&] { plan_of({std::string("contact.restitution=") + e}); },
                                "contact.restitution: ");
}

TEST(TimeStep, TimeIsAStepCount) {
  System s = make_system(good({}), plan_of({}));
  // The same phase in the first period and after 1e8 and 1e15 steps gives the same bits.
  for (const std::int64_t far : {std::int64_t{100'000'000}, std::int64_t{1'000'000'000'000'000}}) {
    const std::int64_t periods = far / s.steps_per_period;
    for (const std::int64_t k : {0, 1, 77, 4711, 70000, 141'000}) {
      s.step = k;
      const double z = s.plate_height(), v = s.plate_velocity();
      s.step = periods * s.steps_per_period + k;
      EXPECT_EQ(s.plate_height(), z);
      EXPECT_EQ(s.plate_velocity(), v);
      EXPECT_EQ(s.time(), static_cast<double>(s.step) * s.dt);
    }
  }
}

TEST(TimeStep, EnergyHasNoDriftIn1e8Steps) {  // an elastic bead between floor and lid
  Bench b(
      "[cell]\ngravity = 0.0\nheight = 1.02\nlid = \"wall\"\n[contact]\ngamma_n = 0.0\ntangential = "
      "\"none\"\n",
      50.37);
  b.add(10, 0.51, 0, 1);
  const auto energy = [&] {
    const Bead& bead = b.system.beads[0];
    const double low = std::max(0.0, 0.5 - bead.z), high = std::max(0.0, bead.z - 0.52);
    return 0.5 * bead.vz * bead.vz + 0.5e6 * (low * low + high * high);
  };
  double first = 0, last = 0, worst = 0;  // means over the first and the last tenth
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 100; ++j) {
      b.kernel->advance(b.system, 100'000);
      const double e = energy();
      if (k == 0) first += e / 100;
      if (k == 9) last += e / 100;
      worst = std::max(worst, std::abs(e / 0.5 - 1));
    }
  EXPECT_EQ(b.system.step, 100'000'000);
  std::printf("energy off by %.1e at most, drift %.1e\n", worst, last / first - 1);
  EXPECT_LE(worst, 3e-3);  // the error of one collision depends on its entry phase, 0.25/n^2
  EXPECT_LE(std::abs(last / first - 1), 5e-4);
}

TEST(TimeStep, PlateTooFastForTheStepIsRefused) {
  expect_refusal<ConfigError>(
      [] {
        plan_of({"drive.gamma=1e5", "time.steps_per_contact=50"});
      },
      "scene.toml: drive: the plate moves 4.4", "sigma in one step, the bound is 0.05");
  expect_refusal<ConfigError>([] { plan_of({"drive.omega=1e-9"}); },
                              "scene.toml: drive: a cycle of 6.28e+09 t0 takes");
  expect_refusal<ConfigError>([] { plan_of({"drive.omega=1e300"}); }, "makes steps of 3.1",
                              "the bound is 1e-12");
  expect_refusal<ConfigError>(
      [] {
        plan_of({"drive.schedule=[[0,1e5],[1,1]]", "time.steps_per_contact=50"});
      },
      "the plate moves 6.6");
}

TEST(TimeStep, BeadBehindAWallIsPushedBackInside) {  // walls are half spaces
  Bench b(kNoGravity + "[contact]\ngamma_n = 0.0\n");
  GuardLimits open;
  open.overlap = 10, open.travel_per_step = 10;
  b.kernel = make_solver(b.plan, open);
  for (const double depth : {0.3, 0.6, 1.5}) {
    b.system.beads.clear();
    b.add(10, 0.5 - depth, 0, 0);
    b.kernel->advance(b.system, 1);
    EXPECT_NEAR(b.system.forces[0].z, 1e6 * (0.5 - b.system.beads[0].z), 1e-6) << depth;
    EXPECT_NEAR(b.system.forces[0].z, 1e6 * depth, 1e4 * depth) << depth;
    EXPECT_GT(b.system.beads[0].vz, 0);
  }
}

TEST(TimeStep, PlateAtAThousandTimesTheSpeedOfTheBeadsStopsTheRun) {
  const Scene scene = good({"time.steps_per_contact=50", "drive.gamma=1000", "drive.start=abrupt",
                            "time.discard=0", "time.cycles=1"});
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  expect_refusal<RunError>([&] { run.run(out); }, "step ", "sigma", "raise contact.k_n");
  EXPECT_GT(out.n_frames(), 0U);
}

TEST(TimeStep, BeadDoesNotPassThroughAnother) {
  for (const double v : {30.0, 100.0, 1e3, 1e4, 1e150}) {
    Bench b(kNoGravity);
    b.kernel = make_solver(b.plan, guard_limits(b.plan));
    b.add(5, 50, v, 0), b.add(9, 50.1, -v, 0);
    if (v < 50) {
      b.advance_time(8 / v);
      EXPECT_LT(b.system.beads[0].x, b.system.beads[1].x);
    } else {
      expect_refusal<RunError>([&] { b.advance_time(8 / v + 10 * b.system.dt); }, "step ", "the bound is");
      EXPECT_LT(b.system.beads[0].x, b.system.beads[1].x) << v;
    }
  }
}

TEST(TimeStep, FramesFallOnPhases) {
  for (const char* phases : {"1", "7", "20", "23"})
    for (const char* n : {"50", "50.37", "8"}) {
      const Plan plan = plan_of({std::string("time.phases=") + phases,
                                 std::string("time.steps_per_contact=") + n, "drive.omega=1.234"});
      EXPECT_EQ(plan.steps_per_period % std::stoi(phases), 0);
      EXPECT_EQ(plan.dt, 2 * std::numbers::pi / 1.234 / static_cast<double>(plan.steps_per_period));
    }
  Simulation run(good({"time.phases=7", "time.steps_per_contact=10", "time.discard=0", "time.cycles=2"}));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  ASSERT_EQ(out.n_frames(), 14U);
  for (std::size_t f = 0; f < 14; ++f) {
    EXPECT_EQ(out.frames()[f].step, static_cast<std::int64_t>(f) * run.plan().steps_per_period / 7);
    EXPECT_EQ(out.frames()[f].plate_height, out.frames()[f % 7].plate_height);
    EXPECT_NEAR(out.frames()[f].plate_height,
                1.5 * std::sin(2 * std::numbers::pi * static_cast<double>(f) / 7), 1e-12);
  }
}

}  // namespace
}  // namespace twincell::sim::time_step_test
