// Which frames of a run are kept for display.
#include "analysis/motion/snapshots.hpp"

#include <gtest/gtest.h>

namespace twincell::analysis::snapshots_test {
namespace {

MemoryTrajectory film(int cycles, int phases, int extra = 0, int first_phase = 0) {
  TrajectoryInfo info;
  info.n_beads = 1;
  info.columns.phase = true;
  info.phases_per_cycle = phases;
  MemoryTrajectory t(info);
  for (int f = 0; f < cycles * phases + extra; ++f) {
    Frame frame;
    frame.step = f;
    frame.phase = (f + first_phase) % phases;
    frame.cycle = (f + first_phase) / phases;
    frame.position = {Vec3(0, 0, 1)};
    t.append(frame);
  }
  return t;
}

}  // namespace

TEST(Snapshots, HalfAtPhaseZeroHalfInTheLastWholeCycle) {
  const auto chosen = representative_frames(film(100, 10, 3), 20);
  ASSERT_EQ(chosen.size(), 20U);
  EXPECT_EQ(chosen.front(), 0U);
  // 100 whole cycles, then three frames of the next cycle, the first of which is a strobe frame (phase 0).
  EXPECT_EQ(chosen.back(), 1000U);
  std::size_t last_cycle = 0;
  for (const std::size_t f : chosen) {
    if (f >= 990 && f < 1000) ++last_cycle;
    EXPECT_TRUE(f % 10 == 0 || (f >= 990 && f < 1000)) << f;
  }
  EXPECT_EQ(last_cycle, 10U);
}

TEST(Snapshots, FewFramesAreAllKeptAndNoneTwice) {
  const auto chosen = representative_frames(film(2, 5), 20);
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 5, 6, 7, 8, 9}));
}

TEST(Snapshots, WithoutPhasesEvenlySpread) {
  MemoryTrajectory t = film(10, 10);
  t.info().columns.phase = false;
  const auto chosen = representative_frames(t, 5);
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 24, 49, 74, 99}));
}

}  // namespace twincell::analysis::snapshots_test
