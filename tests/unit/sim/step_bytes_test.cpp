// The bytes that a profile counts, against the sizes of the records.
#include <gtest/gtest.h>

#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim::step_bytes_test {
namespace {

StageTimes::Row settled(const std::string& beads) {
  const Scene scene =
      read_scene_text("preset = \"fortini-huang-2015\"\n[cell]\nwidth = 4.0\n[beads]\n" + beads +
                          "[drive]\ngamma = 1.5\n[start]\nkind = \"crystal_b\"\nsettle_limit = 0.05\n",
                      "scene.toml");
  StageTimes times;
  Simulation run(scene, placed(scene), SolverKind::best, 1);
  run.settle(Progress::none(), &times);
  return times.rows().front();
}

// A step of a bead in 2D moves its position and velocity, its forces (four numbers each) and its spin twice,
// and the reference of its velocity (two numbers) once. The first and last half step of a call are a step
// more.
TEST(StepBytes, BeadsOnThePlateMoveTheirRecords) {
  const StageTimes::Row row = settled("count = 4\n");  // side by side: pairs that do not touch
  EXPECT_EQ(row.name, "settling");
  ASSERT_GT(row.count, 400);
  constexpr double kRecord = 8 * (2 * (4 + 4 + 1) + 2);
  EXPECT_GE(row.bytes, kRecord * row.count);
  // With pairs: their indices, four springs and velocities, and the padding of a packet of eight.
  EXPECT_LE(row.bytes, 1.1 * (kRecord + 8 * 80) * row.count);
}

// Unlike beads also read the constants of their pairs and their own masses.
TEST(StepBytes, UnlikeBeadsMoveMore) {
  const StageTimes::Row like = settled("count = 16\n");
  const StageTimes::Row unlike = settled("count = 16\nspread = \"uniform\"\nspread_width = 1e-6\n");
  EXPECT_GT(unlike.bytes / unlike.count, like.bytes / like.count + 8 * 5);
}

}  // namespace
}  // namespace twincell::sim::step_bytes_test
