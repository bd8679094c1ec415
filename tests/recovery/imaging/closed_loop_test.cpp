// A known motion is filmed by the synthetic camera, tracked, and compared with itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "imaging/camera/synthetic_camera.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/track.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::closed_loop_test {

using namespace imaging;

namespace {

constexpr int kFramesPerCycle = 20;

/// A crystal that moves with the plate, and above it loose beads on parabolic trajectories.
MemoryTrajectory known_motion() {
  TrajectoryInfo info;
  info.box.upper = Vec3(10, 0.5, 14);
  info.drive = solve_drive(
      {.amplitude = 1, .omega = {}, .frequency = {}, .gamma = 2, .k_m = {}, .peak_velocity = {}}, 1, {});
  info.phases_per_cycle = kFramesPerCycle;
  info.columns.phase = info.columns.plate_height = true;
  info.n_beads = 24;
  MemoryTrajectory truth(info);
  for (int f = 0; f < kFramesPerCycle; ++f) {
    const double fraction = static_cast<double>(f) / kFramesPerCycle, t = fraction * info.drive->period();
    Frame frame;
    frame.step = f;
    frame.time = t;
    frame.phase = f;
    frame.cycle = 0;
    frame.plate_height = info.drive->displacement(fraction);
    for (int i = 0; i < 18; ++i)
      frame.position.emplace_back(0.5 + i % 9 + 0.5 * static_cast<int>(i / 9), 0,
                                  frame.plate_height + 0.5 + std::sqrt(0.75) * static_cast<int>(i / 9));
    for (int i = 0; i < 6; ++i)
      frame.position.emplace_back(1.5 + 1.4 * i + 0.02 * i * t, 0, 5 + 0.5 * i + 1.2 * t - 0.5 * t * t / 2);
    truth.append(frame);
  }
  return truth;
}

MemoryTrajectory track(const std::filesystem::path& folder, int threads,
                       const std::vector<std::string>& set = {}) {
  const CellDescription cell = read_cell(folder / "CELL.toml", set);
  LocatorOptions locator;
  locator.diameter_px = cell.pixels_per_sigma.value();
  const auto frames = open_frames(folder);
  const TrackedStack stack = track_stack(*frames, cell, {.locator = locator, .threads = threads});
  const TrackPlan plan = plan_trajectory(stack, cell, stack.locator.diameter_px, 1);
  MemoryTrajectory result(plan.info);
  write_trajectory(stack, plan, result);
  return result;
}

}  // namespace

// Glare that widens the discs by 2 % leaves the beads as wide as they are.
TEST(ClosedLoop, RadiiAreMeasuredInTheStatedWidthOfTheDiscs) {
  const TemporaryFolder folder;
  render(known_motion(), {}, folder / "frames");
  const MemoryTrajectory usual = track(folder / "frames", 1);
  const MemoryTrajectory wide = track(folder / "frames", 1, {"camera.disc_width_px=15.3"});
  ASSERT_EQ(usual.info().n_beads, wide.info().n_beads);
  for (std::size_t i = 0; i < usual.info().n_beads; ++i) {
    EXPECT_NEAR(usual.info().radius[i], 0.5, 0.01);
    EXPECT_NEAR(wide.info().radius[i], usual.info().radius[i] * 15 / 15.3, 1e-12);
  }
  EXPECT_EQ(usual.frames()[5].position, wide.frames()[5].position);
}

TEST(ClosedLoop, PositionsIdentitiesAndPlateComeBack) {
  const TemporaryFolder folder;
  const MemoryTrajectory truth = known_motion();
  ASSERT_EQ(render(truth, {}, folder / "frames"), truth.n_frames());
  const MemoryTrajectory found = track(folder / "frames", 1);
  ASSERT_EQ(found.n_frames(), truth.n_frames());
  EXPECT_EQ(found.info().n_beads, truth.info().n_beads)
      << "one slot per bead: nobody lost, split or invented";
  EXPECT_EQ(found.info().phases_per_cycle, kFramesPerCycle);
  EXPECT_NEAR(found.info().box.size().x(), 10, 1e-12);
  EXPECT_NEAR(found.info().scale.pixels_per_sigma.value(), 15, 1e-12);

  std::map<std::size_t, std::size_t> slot_of;
  double largest = 0, plate = 0;
  for (std::size_t f = 0; f < truth.n_frames(); ++f) {
    const Frame &a = truth.frames()[f], &b = found.frames()[f];
    plate = std::max(plate, std::abs(a.plate_height - b.plate_height));
    EXPECT_EQ(a.phase, b.phase);
    EXPECT_EQ(a.cycle, b.cycle);
    EXPECT_NEAR(a.time, b.time, 1e-9);
    for (std::size_t i = 0; i < a.position.size(); ++i) {
      std::size_t nearest = 0;
      double least = 1e9;
      for (std::size_t k = 0; k < b.position.size(); ++k)
        if (b.present(k) && (b.position[k] - a.position[i]).norm() < least) {
          least = (b.position[k] - a.position[i]).norm();
          nearest = k;
        }
      largest = std::max(largest, least);
      EXPECT_EQ(slot_of.try_emplace(i, nearest).first->second, nearest) << "bead " << i << ", frame " << f;
    }
  }
  std::cout << "largest error of a position " << largest << " sigma, of the plate's height " << plate
            << " sigma\n";
  EXPECT_LE(largest, 0.05);
  EXPECT_LE(plate, 1e-12);
}

TEST(ClosedLoop, ThreadsDoNotMatter) {
  const TemporaryFolder folder;
  render(known_motion(), {}, folder / "frames");
  const MemoryTrajectory one = track(folder / "frames", 1), two = track(folder / "frames", 2);
  ASSERT_EQ(one.n_frames(), two.n_frames());
  ASSERT_EQ(one.info().n_beads, two.info().n_beads);
  EXPECT_EQ(one.info().radius, two.info().radius);
  for (std::size_t f = 0; f < one.n_frames(); ++f) {
    ASSERT_EQ(one.frames()[f].id, two.frames()[f].id);
    for (std::size_t k = 0; k < one.info().n_beads; ++k)
      for (int a = 0; a < 3 && one.frames()[f].present(k); ++a)
        EXPECT_EQ(one.frames()[f].position[k][a], two.frames()[f].position[k][a]);
  }
}

}  // namespace twincell::closed_loop_test
