// Stretches of a film in which the plate does not follow the drive.
#include "imaging/phase/out_of_lock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.hpp"

namespace twincell::out_of_lock_test {

using namespace imaging;

namespace {

/// Distances from a sine of 20 frames, over a tenth of its amplitude, of a plate that rests at `level` in
/// the given frames and follows the sine in the others.
std::vector<double> misses_of(int frames, const std::vector<FrameStretch>& rests, double level) {
  std::vector<double> misses(static_cast<std::size_t>(frames), 0.0);
  for (const FrameStretch& s : rests)
    for (std::size_t f = s.first; f <= s.last; ++f)
      misses[f] = std::abs(level - std::sin(kTurn * static_cast<double>(f) / 20)) / 0.1;
  return misses;
}

}  // namespace

TEST(OutOfLock, ARestIsOneStretchThoughTheSineCrossesIt) {
  for (const double level : {0.0, 0.7, -0.9}) {
    const auto before = stretches_out_of_lock(misses_of(200, {{0, 39}}, level), 20);
    ASSERT_EQ(before.size(), 1U) << level;
    EXPECT_EQ(before[0].first, 0U) << level;
    EXPECT_NEAR(static_cast<double>(before[0].last), 39, 2) << level;
    const auto after = stretches_out_of_lock(misses_of(200, {{160, 199}}, level), 20);
    ASSERT_EQ(after.size(), 1U) << level;
    EXPECT_NEAR(static_cast<double>(after[0].first), 160, 2) << level;
    EXPECT_EQ(after[0].last, 199U) << level;
  }
  EXPECT_EQ(stretches_out_of_lock(misses_of(300, {{0, 39}, {121, 165}}, 0.2), 20).size(), 2U);
  EXPECT_EQ(frames_in(std::vector<FrameStretch>{{0, 39}, {121, 165}}), 85U);
  EXPECT_EQ(in_words(std::vector<FrameStretch>{{0, 39}, {80, 80}, {121, 165}}), "0 to 39, 80 and 121 to 165");
}

TEST(OutOfLock, SingleMisreadHeightsAndHiddenPhasesAreNone) {
  std::vector<double> misses(200, 0.0);
  for (const std::size_t f : {3, 40, 41, 90, 150, 199}) misses[f] = 8;
  EXPECT_TRUE(stretches_out_of_lock(misses, 20).empty());
  // Beads hide the plate at the same four phases of every cycle.
  std::vector<double> hidden(200, 0.0);
  for (std::size_t f = 0; f < hidden.size(); ++f) hidden[f] = f % 20 < 4 ? 8 : 0;
  EXPECT_TRUE(stretches_out_of_lock(hidden, 20).empty());
  // Frames without a plate say nothing.
  EXPECT_TRUE(stretches_out_of_lock(std::vector<double>(100, kNaN), 20).empty());
  EXPECT_TRUE(stretches_out_of_lock({}, 20).empty());
}

}  // namespace twincell::out_of_lock_test
