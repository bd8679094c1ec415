// Many beads and beads on the plate against closed forms (docs/validation.md: V2.10, V2.12-V2.13, V4.2,
// V4.10, H31).

#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/support/collision.hpp"

namespace twincell::sim {
namespace {

TEST(Bed, LoneBeadFliesAParabola) {  // H31
  Bench b("[contact]\ntangential = \"none\"\n");
  b.add(10, 50, 0.3, 1);
  b.kernel->advance(b.system, 20000);
  const double t = b.system.time();  // 1e-13 a step
  EXPECT_NEAR(b.system.beads[0].x, 10 + 0.3 * t, 1e-9);
  EXPECT_NEAR(b.system.beads[0].z, 50 + t - t * t / 2, 1e-9);
}

TEST(Bed, SlidingBecomesRolling) {  // V2.10: v = 2/3 v_0 for a disc
  Bench b("[contact]\nmu = 0.1\n", 50.37);
  b.add(5, 0.5 - 1e-6, 0.6, 0);  // resting overlap m g/k_n
  b.advance_time(0.6 / (3 * 0.1) * 1.5);
  std::printf("rolling speed over v_0: %.5f, closed form 0.66667\n", b.system.beads[0].vx / 0.6);
  EXPECT_NEAR(b.system.beads[0].vx / 0.6, 2.0 / 3, 0.01);
  EXPECT_NEAR(b.system.beads[0].vx, -0.5 * b.system.beads[0].spin,
              1e-3);  // rolling: the surface stands still
}

TEST(Bed, ColumnCarriesItsWeight) {  // V4.2: overlap of contact i from the top = i m g/k_n
  constexpr int kBeads = 8;
  Bench b("[contact]\ntangential = \"none\"\n", 50.37);
  for (int i = 0; i < kBeads; ++i) b.add(10, 0.5 + i, 0, 0);
  b.advance_time(12);  // the slowest mode decays at about gamma (pi/2n)^2/4
  for (int i = 0; i < kBeads; ++i) {
    const double below = i == 0 ? 0.5 - b.system.beads[0].z
                                : 1 - (b.system.beads[static_cast<std::size_t>(i)].z -
                                       b.system.beads[static_cast<std::size_t>(i - 1)].z);
    EXPECT_NEAR(below, (kBeads - i) * 1e-6, 1e-10 * kBeads) << i;
  }
}

Scene crystal(double gamma, int cycles) {
  return read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 100\n[cell]\nwidth = 10.0\n[drive]\ngamma = " +
          std::to_string(gamma) +
          "\n[time]\nsteps_per_contact = 20\ndiscard = 1\ncycles = " + std::to_string(cycles) + "\n",
      "crystal");
}

/// Standard deviation over the cycle of the bed's mean height above the plate.
double bed_travel(const Scene& scene) {
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  double sum = 0, squares = 0;
  for (const Frame& f : out.frames()) {
    double mean = 0;
    for (const Vec3& r : f.position) mean += r.z() / static_cast<double>(f.position.size());
    const double h = mean - f.plate_height;
    sum += h;
    squares += h * h;
  }
  const double n = static_cast<double>(out.n_frames());
  return std::sqrt(std::max(0.0, squares / n - sum * sum / n / n));
}

TEST(Bed, TakesOffAboveGammaOne) {  // V4.10
  const double below = bed_travel(crystal(0.9, 2)), above = bed_travel(crystal(1.1, 2));
  std::printf("travel of the bed on the plate: %.2e at Gamma 0.9, %.4f at 1.1 (rigid bed: 0.0119)\n", below,
              above);
  EXPECT_LT(below, 1e-3);
  EXPECT_GT(above, 5e-3);
  EXPECT_LT(above, 0.03);
}

TEST(Bed, DriveReturnsToTheSameBitsEveryPeriod) {  // H14, H33
  Simulation run(crystal(1.5, 3));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  EXPECT_EQ(run.plan().steps_per_period % run.scene().phases, 0);
  for (std::size_t f = 20; f < out.n_frames(); ++f) {
    EXPECT_EQ(out.frames()[f].plate_height, out.frames()[f - 20].plate_height);
    EXPECT_EQ(out.frames()[f].phase, static_cast<int>(f % 20));
    EXPECT_EQ(out.frames()[f].cycle, static_cast<std::int64_t>(f / 20));
  }
}

TEST(Bed, SmoothBeadsHaveNoSpinColumn) {
  const Simulation run(
      read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[contact]\nmu = 0.0\n"
                      "[drive]\ngamma = 1.5\n[time]\ndiscard = 0\ncycles = 1\n",
                      "smooth"));
  EXPECT_FALSE(run.plan().rotation);
  EXPECT_FALSE(run.plan().history);
  EXPECT_FALSE(run.trajectory_info().columns.spin);
}

}  // namespace
}  // namespace twincell::sim
