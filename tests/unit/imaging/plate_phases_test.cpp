// Phases from the plate alone, against films whose phases and faults are known.
#include "imaging/phase/plate_phases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace twincell::plate_phases_test {

using namespace imaging;

namespace {

/// Heights of a plate at the given ticks. \param period frames \param noise px
std::vector<double> plate_at(const std::vector<double>& ticks, double period, double amplitude,
                             double noise) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> heights;
  for (const double t : ticks)
    heights.push_back(40 + noise * normal(generator) +
                      amplitude * std::sin(2 * std::numbers::pi * t / period));
  return heights;
}

/// Ticks of `frames` frames that begin at `first`; a frame is missing before each of `dropped`, and each of
/// `doubled` repeats the instant before it.
std::vector<double> ticks_of(int frames, int first, const std::vector<int>& dropped,
                             const std::vector<int>& doubled) {
  std::vector<double> ticks;
  double tick = first;
  for (int f = 0; f < frames; ++f) {
    if (f > 0) ++tick;
    for (const int d : dropped) tick += d == f ? 1 : 0;
    for (const int d : doubled) tick -= d == f ? 1 : 0;
    ticks.push_back(tick);
  }
  return ticks;
}

}  // namespace

TEST(PlatePhases, EveryFrameOfADamagedFilmGetsItsPhase) {
  for (const int n : {12, 20, 48})
    for (const int stated : {n, 0})
      for (const int first : {0, 7}) {
        const std::vector<double> ticks = ticks_of(5 * n, first, {n + 3, 3 * n}, {2 * n + n / 4});
        const auto table = phases_from_plate(plate_at(ticks, n, 12, 0.1), stated);
        ASSERT_TRUE(table) << n << ' ' << stated;
        EXPECT_EQ(table->frames_per_cycle, n) << stated;
        EXPECT_EQ(table->dropped, 2) << n << ' ' << stated;
        EXPECT_EQ(table->doubled, 1) << n << ' ' << stated;
        int wrong = 0;
        for (std::size_t f = 0; f < ticks.size(); ++f) {
          const FramePhase at = table->at(static_cast<std::int64_t>(f));
          wrong += at.phase + n * at.cycle == std::llround(ticks[f]) ? 0 : 1;
        }
        // Noise of 0.1 px cannot tell the two frames at the plate's turning point apart.
        EXPECT_LE(wrong, n / 12) << n << ' ' << stated;
      }
}

TEST(PlatePhases, AnIntactFilmHasNoFaultsInNoise) {
  for (const double noise : {0.0, 0.3, 1.0})
    for (const int stated : {20, 0}) {
      const auto table = phases_from_plate(plate_at(ticks_of(240, 4, {}, {}), 20, 12, noise), stated);
      ASSERT_TRUE(table) << noise;
      EXPECT_EQ(table->frames_per_cycle, 20) << noise;
      EXPECT_EQ(table->first_phase, 4) << noise;
      EXPECT_EQ(table->dropped + table->doubled, 0) << noise;
    }
}

// A drift of a fifth of a frame: a bed at rest on such a plate seemed to bounce.
TEST(PlatePhases, ASmallDriftAgainstAWholeNumberIsFollowed) {
  for (const double period : {25.5, 25.12, 25.08, 24.92, 24.96})
    for (const int frames : {52, 126}) {
      const double drift = std::abs(25 / period - 1) * frames;
      if (drift < 0.15) continue;
      const std::vector<double> heights = plate_at(ticks_of(frames, 4, {}, {}), period, 19, 0.1);
      const auto table = phases_from_plate(heights, 0);
      ASSERT_TRUE(table) << period;
      ASSERT_TRUE(table->period_frames) << period << ' ' << frames;
      EXPECT_NEAR(*table->period_frames, period, 0.02 * 52 / frames) << frames;
      EXPECT_EQ(table->dropped + table->doubled, 0) << period;
      for (int f = 0; f < frames; f += 5) {
        const double turn = 2 * std::numbers::pi * table->cycles_at(f).value();
        EXPECT_NEAR(40 + 19 * std::sin(turn), heights[static_cast<std::size_t>(f)], 0.45)
            << period << ' ' << f;
      }
    }
}

TEST(PlatePhases, ADelayOfAllFramesDoesNotMoveTheFirstPhase) {
  std::vector<double> ticks = ticks_of(120, 3, {}, {});
  for (double& t : ticks) t += 0.49;
  const std::vector<double> heights = plate_at(ticks, 20, 12, 0);
  EXPECT_EQ(phases_from_plate(heights, 20, 0.49)->first_phase, 3);
  EXPECT_EQ(phases_from_plate(heights, 20, -0.51)->first_phase, 4);
}

TEST(PlatePhases, UninformativePlateGivesNoPhases) {
  const std::vector<double> ticks = ticks_of(200, 0, {}, {});
  EXPECT_FALSE(phases_from_plate({}, 0));
  EXPECT_FALSE(phases_from_plate(std::vector<double>(200, std::numeric_limits<double>::quiet_NaN()), 20));
  EXPECT_FALSE(phases_from_plate(std::vector<double>(200, 40.0), 20)) << "at rest";
  EXPECT_FALSE(phases_from_plate(plate_at(ticks, 20, 0.8, 0), 20)) << "moves by less than a pixel";
  EXPECT_FALSE(phases_from_plate(plate_at(ticks, 20, 12, 0), 24)) << "another number of frames per cycle";
  EXPECT_FALSE(phases_from_plate(plate_at(ticks, 20, 12, 0), 2));
}

TEST(PlatePhases, APeriodThatIsNoWholeNumberOfFramesIsKept) {
  for (const double noise : {0.0, 0.3})
    for (const double period : {20.5, 19.6, 13.0 + 1.0 / 3})
      for (const int stated : {0, static_cast<int>(std::lround(period))}) {
        const std::vector<double> ticks = ticks_of(300, 3, {}, {});
        const auto table = phases_from_plate(plate_at(ticks, period, 12, noise), stated);
        ASSERT_TRUE(table) << period << ' ' << stated;
        EXPECT_EQ(table->frames_per_cycle, static_cast<int>(period + 0.1)) << stated;
        EXPECT_NEAR(table->period_frames.value(), period, 0.01) << stated;
        EXPECT_EQ(table->dropped + table->doubled, 0) << period << ' ' << stated;
        for (std::size_t f = 0; f < ticks.size(); ++f)
          EXPECT_NEAR(table->cycles_at(static_cast<std::int64_t>(f)).value() * period, ticks[f], 0.1)
              << period << ' ' << stated << ' ' << f;
      }
}

TEST(PlatePhases, FramesBeforeTheShakerStartsHaveNoPhase) {
  for (const int rest : {40, 100})
    for (const double noise : {0.0, 0.3}) {
      std::vector<double> heights(static_cast<std::size_t>(rest), 40.0);
      const std::vector<double> moving = plate_at(ticks_of(240, 0, {}, {}), 20, 12, noise);
      heights.insert(heights.end(), moving.begin(), moving.end());
      const auto table = phases_from_plate(heights, 20);
      ASSERT_TRUE(table) << rest << ' ' << noise;
      EXPECT_EQ(table->dropped + table->doubled, 0) << rest << ' ' << noise;
      ASSERT_EQ(table->out_of_lock.size(), 1U) << rest << ' ' << noise;
      EXPECT_NEAR(static_cast<double>(frames_in(table->out_of_lock)), rest, 2) << noise;
      EXPECT_NE(table->warning.find("does not follow the drive"), std::string::npos) << table->warning;
      EXPECT_EQ(table->at(rest + 45).phase, 5) << rest << ' ' << noise;
    }
}

}  // namespace twincell::plate_phases_test
