// A constant attraction while surfaces are in contact (docs/validation.md: V1.12).

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/error.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::cohesive_test {
namespace {

using test::validate;

constexpr double kStiffness = 1e6, kDamping = 100, kPullOff = 200;  // m = 1; at the wall gamma = 100

std::string contact() {
  return "[contact]\nnormal = \"cohesive\"\ntangential = \"none\"\npull_off_force = " +
         std::to_string(kPullOff) + "\n[contact.wall]\ngamma_n = " + std::to_string(kDamping) +
         "\n[time]\nintegrator = \"split\"\n";
}

/// Overlap of a bead that hits the wall at speed v: m d'' = F_c - eta d' - k d.
double overlap_at(double t, double v) {
  const double beta = kDamping / 2, w = std::sqrt(kStiffness - beta * beta), rest = kPullOff / kStiffness;
  const double sine = (v - beta * rest) / w;
  return rest + std::exp(-beta * t) * (-rest * std::cos(w * t) + sine * std::sin(w * t));
}

/// Restitution of that motion at the instant when the overlap returns to 0; 0 if it never does.
double restitution(double v) {
  const double period = 2 * std::acos(-1.0) / std::sqrt(kStiffness);
  double low = 0.1 * period;
  const double step = 1e-4 * period;
  while (low < 2 * period && overlap_at(low + step, v) > 0) low += step;
  if (low >= 2 * period) return 0;
  double high = low + step;
  for (int k = 0; k < 60; ++k) (overlap_at(0.5 * (low + high), v) > 0 ? low : high) = 0.5 * (low + high);
  const double h = 1e-9;
  return (overlap_at(low - h, v) - overlap_at(low + h, v)) / (2 * h) / v;
}

TEST(Cohesive, FastBeadsLeaveWithARestitutionThatDependsOnTheSpeed) {
  for (const double v : {0.6, 1.0, 3.0}) {
    const double exact = restitution(v);
    ASSERT_GT(exact, 0.1) << v;
    const auto e =
        over_entry_phases([&](double p) { return wall_restitution(contact(), 100.37, v, p); }, exact, 16);
    validate({"V1.12", "e of a bead on a cohesive wall, v = " + std::to_string(v).substr(0, 3), exact, 2e-3,
              "damped oscillator about F_c/k_n"},
             exact + e.mean);
  }
}

// Tested from both sides: the closed form puts the lowest escape speed between these speeds.
TEST(Cohesive, SlowBeadsAreCaptured) {
  double low = 0.01, high = 3;
  ASSERT_EQ(restitution(low), 0);
  for (int k = 0; k < 40; ++k) (restitution(0.5 * (low + high)) > 0 ? high : low) = 0.5 * (low + high);
  for (const double factor : {0.95, 1.05}) {
    Bench b(kNoGravity + contact(), 100.37);
    b.add(10, 0.5 + 1e-4, 0, -factor * high);
    b.advance_time(0.3);
    const double height = b.system.beads[0].z - 0.5;
    if (factor < 1)
      EXPECT_LT(height, 0) << "captured below " << high;
    else
      EXPECT_GT(height, 0) << "free above " << high;
  }
}

TEST(Cohesive, ACapturedBeadRestsAtTheOverlapOfItsPullOffForce) {
  Bench b(kNoGravity + contact(), 50.37);
  b.add(10, 0.5, 0, -0.05);
  b.advance_time(0.5);
  validate({"V1.12", "overlap of a captured bead at rest", kPullOff / kStiffness, 1e-9, "F_c/k_n"},
           0.5 - b.system.beads[0].z);
}

// An attractive contact may last for ever, and friction begins while the surfaces attract each other.
// Integrating a contact in isolation is then not exact, so the plan uses time steps only.
TEST(Cohesive, BeadsMoveByStepsOnly) {
  const std::string scene = "[beads]\ncount = 20\n[drive]\nomega = 1.0\nk_m = 100.0\n" + contact();
  EXPECT_FALSE(make_plan(read_scene_text(scene, "s")).event_driven);
  try {
    (void)make_plan(read_scene_text(scene, "s", {"time.stepping=event-driven"}));
    ADD_FAILURE() << "event-driven cohesive beads were accepted";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("attracts"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace twincell::sim::cohesive_test
