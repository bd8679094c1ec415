// Warnings of a plan about settings that run but may not be intended.

#include "sim/scene/plan_warnings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim::plan_warnings_test {
namespace {

bool warns_of_lost_energy(const std::string& contact, const std::string& time = "") {
  const Plan plan = make_plan(read_scene_text(
      "[beads]\ncount = 40\n[cell]\nwidth = 8.0\n[drive]\ngamma = 2.0\nomega = 1.0\n[contact]\n" + contact +
          "[time]\n" + time,
      "scene.toml"));
  return std::any_of(plan.warnings.begin(), plan.warnings.end(), [](const std::string& warning) {
    return warning.find("no contact dissipates energy") != std::string::npos;
  });
}

TEST(PlanWarnings, OfEnergyThatOnlyStepsTake) {
  const std::string smooth = "mu = 0.0\n", hertz = "normal = \"hertz\"\nyoungs_modulus = 1e6\nmu = 0.0\n";
  EXPECT_TRUE(warns_of_lost_energy("restitution = 1.0\n" + smooth));
  EXPECT_TRUE(warns_of_lost_energy("c_n = 0.0\n" + smooth));
  EXPECT_TRUE(warns_of_lost_energy(hertz));
  EXPECT_TRUE(
      warns_of_lost_energy("normal = \"velocity-dependent-restitution\"\nrestitution_fast = 1.0\n" + smooth));
  // Something dissipates.
  EXPECT_FALSE(warns_of_lost_energy("restitution = 0.99\n" + smooth));
  EXPECT_FALSE(warns_of_lost_energy("restitution = 1.0\nmu = 0.1\nk_t = 1e4\n"));
  EXPECT_FALSE(warns_of_lost_energy(hertz + "viscous_time = 1e-5\n"));
  EXPECT_FALSE(warns_of_lost_energy("restitution = 1.0\n" + smooth + "[contact.wall]\nrestitution = 0.9\n"));
  EXPECT_FALSE(warns_of_lost_energy("normal = \"velocity-dependent-restitution\"\n" + smooth));
  // The loss does not add up, or not noticeably.
  EXPECT_FALSE(warns_of_lost_energy("restitution = 1.0\n" + smooth, "integrator = \"verlet\"\n"));
  EXPECT_FALSE(warns_of_lost_energy("restitution = 1.0\n" + smooth, "steps_per_contact = 100\n"));
  EXPECT_FALSE(warns_of_lost_energy("restitution = 1.0\n" + smooth, "stepping = \"event-driven\"\n"));
}

}  // namespace
}  // namespace twincell::sim::plan_warnings_test
