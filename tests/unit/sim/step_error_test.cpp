// The error of e that `explain` reports, against values from outside the code: closed forms of e, and errors
// measured by an independent program.

#include "sim/accuracy/step_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim::step_error_test {
namespace {

struct Explained {
  Scene scene;
  Plan plan;
  std::optional<StepError> error;

  explicit Explained(const std::string& more)
      : scene(read_scene_text("[beads]\ncount = 4\n[cell]\nwidth = 8.0\n" + more, "scene.toml")),
        plan(make_plan(scene)),
        error(step_error(scene, plan, 128)) {}
  [[nodiscard]] std::string reason() {
    state_step_error(scene, plan);
    return reason_as_stated();
  }
  [[nodiscard]] std::string reason_as_stated() const {
    return std::find_if(plan.effects.begin(), plan.effects.end(),
                        [](const Effect& e) { return e.name == kTimeIntegration; })
        ->reason;
  }
};

std::string stepped(double n, const std::string& integrator = "verlet") {
  return "[drive]\ngamma = 1.5\nomega = 1.0\n[time]\nsteps_per_contact = " + std::to_string(n) +
         "\nintegrator = \"" + integrator + "\"\n";
}

TEST(StepError, IsThatOfTheFirstPapersBeads) {
  struct Row {
    double n, mean, rms, largest;
  };
  for (const Row& row : {Row{20.37, -1.2e-4, 4.6e-3, 9.2e-3},
                         {50.37, -1.1e-4, 1.8e-3, 3.2e-3},
                         {100.37, -5.0e-5, 9.2e-4, 1.5e-3}}) {
    const Explained e("[contact]\ngamma_n = 100.0\n" + stepped(row.n));
    ASSERT_TRUE(e.error);
    EXPECT_NEAR(e.error->restitution, 0.8948121, 1e-6);
    EXPECT_NEAR(e.error->error.rms, row.rms, 0.06 * row.rms) << row.n;
    EXPECT_NEAR(e.error->error.largest, row.largest, 0.1 * row.largest) << row.n;
    EXPECT_NEAR(e.error->error.mean, row.mean, 0.6 * std::abs(row.mean)) << row.n;
  }
}

TEST(StepError, FollowsTheScenesOwnRestitution) {
  for (const double e : {0.95, 0.7, 0.5, 0.3}) {
    const Explained scene("[contact]\nrestitution = " + std::to_string(e) + "\n" + stepped(50.37));
    ASSERT_TRUE(scene.error);
    EXPECT_NEAR(scene.error->restitution, e, 1e-6);
    if (e == 0.5) {
      EXPECT_NEAR(scene.error->error.largest, 0.79 / 50.37, 0.1 * 0.79 / 50.37);
    }
  }
  // The split integrator is of second order.
  const auto split = [](double n) {
    return Explained("[contact]\nrestitution = 0.7\n" + stepped(n, "split")).error->error.rms;
  };
  EXPECT_NEAR(std::log2(split(50.37) / split(201.48)) / 2, 2, 0.25);
}

TEST(StepError, FollowsTheScenesOwnLaw) {
  // Schwager & Poeschel 2007 for the paper's damping; for the other laws, e at the impact speed.
  const Explained clipped("[contact]\nnormal = \"linear-no-tension\"\ngamma_n = 100.0\n" + stepped(50.37));
  ASSERT_TRUE(clipped.error);
  EXPECT_NEAR(clipped.error->restitution, 0.897054, 1e-6);
  const Explained falling(
      "[contact]\nnormal = \"velocity-dependent-restitution\"\nrestitution_fast = 0.5\nrestitution_speed = "
      "9.0\n" +
      stepped(50.37));
  ASSERT_TRUE(falling.error);
  EXPECT_NEAR(falling.error->speed, 3, 1e-12);  // twice Gamma g/omega
  EXPECT_NEAR(falling.error->restitution, 1 - 0.5 * std::pow(3.0 / 9, 0.75), 1e-5);
  const Explained hertz("[contact]\nnormal = \"hertz\"\nyoungs_modulus = 1e7\n" + stepped(50.37));
  ASSERT_TRUE(hertz.error);
  EXPECT_NEAR(hertz.error->restitution, 1, 1e-6);
}

TEST(StepError, IsOfStepsAlsoWhereBeadsWouldFlyWithoutGravity) {
  const Explained e("[contact]\ntangential = \"none\"\ngamma_n = 100.0\n" + stepped(50.37));
  ASSERT_TRUE(e.error);
  EXPECT_NEAR(e.error->error.largest, 3.2e-3, 3e-4);
  EXPECT_FALSE(e.error->friction);
}

TEST(StepError, OfFrictionIsThatOfSlidingImpacts) {
  // The first paper's beads: the error is a fifth of the effect of friction at n = 50 with Verlet, and a
  // hundredth of that with the split integrator.
  const std::string law = "[contact]\ngamma_n = 100.0\ngamma_t = 100.0\nk_t = 1e4\nmu = 0.6\n";
  Explained verlet(law + stepped(50.37));
  const Explained fine(law + stepped(201.48)), split(law + stepped(50.37, "split"));
  ASSERT_TRUE(verlet.error && verlet.error->friction && split.error && split.error->friction);
  const ImpactErrors& e = *verlet.error->friction;
  EXPECT_NEAR(e.spin.rms / e.spin_change, 0.22, 0.05);
  EXPECT_NEAR(e.spin.rms / fine.error->friction->spin.rms, 4, 0.8) << "first order";
  EXPECT_LT(split.error->friction->spin.rms, 0.02 * e.spin.rms);
  EXPECT_NE(verlet.reason().find("friction changes R w by 0.0"), std::string::npos) << verlet.reason();
  // The slider of the dashpot law has no spring and therefore a different error.
  const Explained dashpot(
      "[contact]\nrestitution = 0.9\ntangential = \"dashpot\"\nc_t_over_c_n = 1.0\nmu = 0.4\n" +
      stepped(50.37));
  ASSERT_TRUE(dashpot.error && dashpot.error->friction);
  EXPECT_GT(dashpot.error->friction->spin.rms, 1e-5);
  EXPECT_LT(dashpot.error->friction->spin.rms, 0.01);
}

TEST(StepError, OfFrictionIsOfTheStepThatStifferWallsSet) {
  const std::string law = "[contact]\ngamma_n = 100.0\ngamma_t = 100.0\nk_t = 1e4\nmu = 0.6\n";
  const Explained stiff(law + "[contact.wall]\nk_n = 1e8\n" + stepped(50.37));
  // sqrt(50) is the contact time of two beads over that of bead and wall.
  const Explained fine(law + stepped(50.37 * std::sqrt(50.0)));
  ASSERT_NEAR(stiff.plan.dt / fine.plan.dt, 1, 0.02);
  EXPECT_NEAR(stiff.error->friction->spin.rms / fine.error->friction->spin.rms, 1, 0.05);
}

/// Two beads at a large distance with these velocities along x, in a table start without gravity and drive.
StartSpeeds of_two_beads(const Scene& scene, double v_i, double v_j) {
  std::vector<Bead> beads(2);
  beads[0].vx = v_i, beads[1].vx = v_j;
  const auto speeds = speeds_of_start(scene, beads);
  EXPECT_TRUE(speeds);
  return speeds.value_or(StartSpeeds{});
}

const char* const kFreeSpace =
    "gravity = 0.0\nlid = \"wall\"\nheight = 20.0\n[start]\nkind = \"random\"\n[drive]\namplitude = "
    "0.0\nomega = 1.0\n";

TEST(StepError, IsAtTheSpeedsOfTheStart) {
  Explained hertz(std::string(kFreeSpace) +
                  "[contact]\nnormal = \"hertz\"\nyoungs_modulus = 1e9\nviscous_time = 2e-6\n");
  const StartSpeeds alike = of_two_beads(hertz.scene, 5, -5), wall = of_two_beads(hertz.scene, 3, 3);
  EXPECT_NEAR(alike.typical, 10, 1e-12);
  EXPECT_NEAR(alike.largest, 10, 1e-12);
  EXPECT_NEAR(wall.typical, 3, 1e-12);
  EXPECT_NEAR(wall.largest, 3, 1e-12);
  EXPECT_EQ(stated_speeds(hertz.scene, hertz.plan, alike), std::vector<double>{10});
  EXPECT_EQ(stated_speeds(hertz.scene, hertz.plan, {}), std::vector<double>{1e-3});
  const std::vector<double> two = stated_speeds(hertz.scene, hertz.plan, StartSpeeds{1, 20});
  EXPECT_EQ(two, (std::vector<double>{1, 20}));
  // e of viscoelastic beads falls with the speed: 1 - e ~ v^(1/5).
  state_step_error(hertz.scene, hertz.plan, StartSpeeds{1, 20});
  const std::string text = hertz.reason_as_stated();
  EXPECT_NE(text.find("meet at v = 1 is 0.98"), std::string::npos) << text;
  EXPECT_NE(text.find("; e of two beads that meet at v = 20 is 0.97"), std::string::npos) << text;
}

TEST(StepError, SaysAtWhichSpeedCohesionHoldsBeads) {
  // Beads part if their energy outlasts the attraction and the dashpot: at 1, not at 0.001.
  Explained cohesive(
      std::string(kFreeSpace) +
      "[contact]\nnormal = \"cohesive\"\nk_n = 1e6\ngamma_n = 100.0\npull_off_force = 100.0\n");
  EXPECT_FALSE(step_error(cohesive.scene, cohesive.plan, 4, 1e-3));
  EXPECT_TRUE(step_error(cohesive.scene, cohesive.plan, 4, 1.0));
  state_step_error(cohesive.scene, cohesive.plan, StartSpeeds{0.01, 1});
  const std::string text = cohesive.reason_as_stated();
  EXPECT_NE(text.find("two beads that meet at v = 0.01 do not part; e of two beads that meet at v = 1 is 0."),
            std::string::npos)
      << text;
}

TEST(StepError, OfABedThatSettlesIsThatOfItsForces) {
  const Explained bed(stepped(20, "split"));
  std::vector<Bead> beads(2);
  beads[0].vx = 50;
  EXPECT_FALSE(speeds_of_start(bed.scene, beads)) << "settling takes these velocities away";
  EXPECT_EQ(stated_speeds(bed.scene, bed.plan, {}), std::vector<double>{bed.error->speed});
}

TEST(StepError, IsOfTheUsualBeadAndSaysSo) {
  const std::string contact = "[contact]\nrestitution = 0.9\n";
  Explained equal(contact + stepped(50)),
      large("[beads.intruder]\nradius = 1.5\nmass = 27.0\nx = 4.0\nz = 4.0\n" + contact + stepped(50));
  EXPECT_EQ(equal.error->restitution, large.error->restitution);
  EXPECT_NE(equal.reason().find("meet at v = 3 is 0.9 and errs by up to 0.00"), std::string::npos)
      << equal.reason();
  Explained stuck("[contact]\nc_n = 2000.0\n" + stepped(50));  // c_n = 2 sqrt(k_n m_eff) is 1414
  EXPECT_FALSE(stuck.error);
  EXPECT_NE(stuck.reason().find("do not part"), std::string::npos) << stuck.reason();
}

}  // namespace
}  // namespace twincell::sim::step_error_test
