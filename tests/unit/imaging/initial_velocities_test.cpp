// Displacements of the beads from the first frame, found by tracking backwards from the first calm frame.

#include "imaging/link/initial_velocities.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace twincell::imaging::initial_velocities_test {
namespace {

constexpr double kD = 15;
constexpr std::size_t kFrames = 30;

/// A square patch of beads, 1.1 d apart, that is thrown apart and comes to rest. Its rim moves farther in the
/// first frame than the distance between neighbours, so that a single pair of frames has several plausible
/// matches.
std::vector<FrameOfBeads> burst(std::size_t frames = kFrames, double growth = 1) {
  std::vector<FrameOfBeads> all(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    const double wide = 1.1 * kD * (1 + growth * (1 - std::exp(-static_cast<double>(f) / 6)));
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j)
        all[f].places.push_back(
            {500 + wide * (i + 0.1 * std::sin(5 * i + j)), 500 + wide * (j + 0.1 * std::cos(i + 7 * j))});
  }
  return all;
}

std::vector<PixelPoint> steps_of(const std::vector<FrameOfBeads>& frames) {
  return initial_velocities({.diameter_px = kD}, 0, frames.size(),
                            [&](std::size_t f) { return frames.at(f); });
}

/// Number of links to a bead other than the one of the frame before; beads keep their order from frame to
/// frame.
std::size_t wrong(const std::vector<FrameOfBeads>& frames, const std::vector<PixelPoint>& steps) {
  Linker linker({.diameter_px = kD});
  linker.begin(steps);
  std::size_t n = 0;
  std::vector<std::int64_t> before;
  for (const FrameOfBeads& frame : frames) {
    const std::vector<std::int64_t> ids = linker.next(frame.places);
    for (std::size_t k = 0; k < before.size(); ++k) n += ids[k] != before[k] ? 1 : 0;
    before = ids;
  }
  return n;
}

TEST(InitialVelocities, AStackThatBeginsInABurstIsFollowedBackToIt) {
  const std::vector<FrameOfBeads> frames = burst();
  const std::vector<PixelPoint> steps = steps_of(frames);
  ASSERT_EQ(steps.size(), frames[0].places.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    EXPECT_NEAR(steps[k].x_px, frames[1].places[k].x_px - frames[0].places[k].x_px, 1e-9) << k;
    EXPECT_NEAR(steps[k].y_px, frames[1].places[k].y_px - frames[0].places[k].y_px, 1e-9) << k;
  }
  EXPECT_GT(wrong(frames, {}), 50U);  // otherwise the test would show nothing
  EXPECT_EQ(wrong(frames, steps), 0U);
}

TEST(InitialVelocities, CalmStartGivesNoNote) {
  EXPECT_TRUE(steps_of(burst(kFrames, 0)).empty());
  EXPECT_TRUE(steps_of(burst(kFrames, 0.02)).empty());
}

TEST(InitialVelocities, BeadMissingInTheSecondFrameHasNone) {
  std::vector<FrameOfBeads> frames = burst();
  frames[1].places.erase(frames[1].places.begin());  // a corner bead
  const std::vector<PixelPoint> steps = steps_of(frames);
  ASSERT_EQ(steps.size(), frames[0].places.size());
  EXPECT_TRUE(std::isnan(steps[0].x_px));
  EXPECT_EQ(std::count_if(steps.begin(), steps.end(), [](PixelPoint s) { return std::isnan(s.x_px); }), 1);
}

TEST(InitialVelocities, TheFallIsTakenOff) {
  constexpr double kFall = 1.5;
  std::vector<FrameOfBeads> frames = burst();
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (PixelPoint& p : frames[f].places) p.y_px += 0.5 * kFall * std::pow(static_cast<double>(f), 2);
  const std::vector<PixelPoint> steps = initial_velocities(
      {.diameter_px = kD, .fall_px = kFall}, 0, frames.size(), [&](std::size_t f) { return frames.at(f); });
  ASSERT_EQ(steps.size(), frames[0].places.size());
  for (std::size_t k = 0; k < steps.size(); ++k)
    EXPECT_NEAR(steps[k].y_px, frames[1].places[k].y_px - frames[0].places[k].y_px - kFall, 1e-9) << k;
}

TEST(InitialVelocities, ShortAndEmptyStacksHaveNone) {
  EXPECT_TRUE(steps_of({}).empty());
  EXPECT_TRUE(steps_of(burst(1)).empty());
  EXPECT_TRUE(steps_of(burst(2)).empty());
  EXPECT_TRUE(steps_of(std::vector<FrameOfBeads>(5)).empty());
}

}  // namespace
}  // namespace twincell::imaging::initial_velocities_test
