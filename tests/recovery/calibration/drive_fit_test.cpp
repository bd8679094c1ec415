// The drive from heights with known parameters: bias and rms separately, coverage of the stated intervals,
// and laboratory faults: outliers, missing and duplicated frames, jitter, and a shaker whose motion is not a
// sine.
#include "calibration/drive/drive_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "calibration/drive/accelerometer.hpp"
#include "core/error.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::drive_fit_test {

using namespace calibration;

namespace {

constexpr double kPi = std::numbers::pi;

struct Shaker {
  double z0 = 3, amplitude = 12, period = 20, phi = 0.7;
  double noise = 0.05, jitter = 0, second = 0, second_phase = 0;
  double outliers = 0;  ///< fraction, up to 40 px upwards: beads mistaken for the plate
  double missing = 0;   ///< fraction
  int frames = 200;
};

std::vector<double> heights_of(const Shaker& s, std::mt19937_64& generator) {
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> h;
  for (int f = 0; f < s.frames; ++f) {
    const double theta = 2 * kPi * (f + s.jitter * normal(generator)) / s.period + s.phi;
    double z = s.z0 +
               s.amplitude * (std::sin(theta) + s.second * std::sin(2 * theta + 2 * kPi * s.second_phase)) +
               s.noise * normal(generator);
    if (uniform(generator) < s.outliers) z += 1 + 39 * uniform(generator);
    h.push_back(uniform(generator) < s.missing ? std::nan("") : z);
  }
  return h;
}

double cycles_apart(double a, double b) {
  return std::remainder(a - b, 2 * kPi);
}

/// Bias, rms and coverage of A, omega and phi over many seeds, without a trigger and without a known period.
void recover(const char* what, const Shaker& truth, int trials) {
  std::mt19937_64 generator(20);
  struct Number {
    const char* name;
    double bias = 0, squares = 0;
    int covered = 0;
  };
  Number numbers[4] = {{"A"}, {"omega"}, {"phi"}, {"z0"}};
  for (int i = 0; i < trials; ++i) {
    const DriveFit l = fit_drive(heights_of(truth, generator));
    const double errors[4] = {l.amplitude - truth.amplitude, l.omega - 2 * kPi / truth.period,
                              cycles_apart(l.phi, truth.phi), l.z0 - truth.z0};
    const double stated[4] = {l.amplitude_error, l.omega_error, l.phi_error, l.z0_error};
    for (int k = 0; k < 4; ++k) {
      numbers[k].bias += errors[k] / trials;
      numbers[k].squares += errors[k] * errors[k] / trials;
      numbers[k].covered += std::abs(errors[k]) <= 1.972 * stated[k] ? 1 : 0;  // t, 194 degrees of freedom
    }
  }
  int covered = 0;
  for (const Number& n : numbers) {
    const double rms = std::sqrt(n.squares);
    std::cout << what << ", " << n.name << ": bias " << n.bias << ", rms " << rms << ", coverage "
              << 100.0 * n.covered / trials << " %\n";
    EXPECT_LE(std::abs(n.bias), 4 * rms / std::sqrt(trials)) << n.name;
    covered += n.covered;
  }
  EXPECT_GE(covered, 0.93 * 4 * trials) << what;
  EXPECT_LE(covered, 0.97 * 4 * trials) << what;
}

}  // namespace

TEST(DriveFit, IntervalsCoverWithoutATrigger) {
  recover("clean", {}, 400);
}

TEST(DriveFit, IntervalsCoverWithOutliersAndMissingFrames) {
  recover("20 % outliers, 10 % missing", {.outliers = 0.2, .missing = 0.1}, 400);
}

TEST(DriveFit, ExactHeightsGiveTheDriveBack) {
  std::mt19937_64 generator(1);
  for (const double period : {20.0, 7.3, 50.0})
    for (const double phi : {-3.0, 0.0, 1.3}) {
      const DriveFit l = fit_drive(heights_of({.period = period, .phi = phi, .noise = 0}, generator));
      EXPECT_NEAR(l.amplitude, 12, 1e-8);
      EXPECT_NEAR(l.period, period, 1e-8);
      EXPECT_NEAR(cycles_apart(l.phi, phi), 0, 1e-8);
    }
}

TEST(DriveFit, PhasesAreThoseOfTheCell) {
  std::mt19937_64 generator(2);
  // Frame 0 is at phase 3 and a quarter of a frame late.
  const DriveFit l = fit_drive(heights_of({.phi = 2 * kPi * 3.25 / 20}, generator));
  EXPECT_EQ(l.frames_per_cycle, 20);
  EXPECT_EQ(l.first_phase, 3);
  EXPECT_NEAR(l.phase_offset, 0.25, 5 * l.phase_offset_error);
  EXPECT_LT(l.phase_offset_error, 0.005);
  EXPECT_EQ(fit_drive(heights_of({.period = 19.7}, generator)).frames_per_cycle, 0) << "no whole number";
}

TEST(DriveFit, AShakerThatIsNoSineIsReportedAndASineIsNot) {
  std::mt19937_64 generator(3);
  const DriveFit bent = fit_drive(heights_of({.second = 0.01}, generator));
  EXPECT_NEAR(*bent.second_harmonic, 0.01, 4 * *bent.second_harmonic_error);
  EXPECT_LT(*bent.p_sinusoidal, 1e-6);
  for (const double phase : {0.1, 0.35, 0.8}) {
    const DriveFit d = fit_drive(heights_of({.second = 0.05, .second_phase = phase}, generator));
    EXPECT_NEAR(*d.second_harmonic_phase, phase, 0.01);
  }
  EXPECT_FALSE(bent.notes.empty());
  int alarms = 0;
  const int trials = 300;
  for (int i = 0; i < trials; ++i)
    alarms += *fit_drive(heights_of({}, generator)).p_sinusoidal < 0.05 ? 1 : 0;
  std::cout << "false alarms at 5 %: " << 100.0 * alarms / trials << " %\n";
  EXPECT_GE(alarms, 4);  // 0.05 of 300 is 15 +- 3.8
  EXPECT_LE(alarms, 28);
}

TEST(DriveFit, JitterIsMeasured) {
  std::mt19937_64 generator(4);
  double sum = 0, squares = 0;
  const int trials = 100;
  int found = 0;
  for (int i = 0; i < trials; ++i) {
    const DriveFit l = fit_drive(heights_of({.jitter = 0.05, .frames = 400}, generator));
    if (!l.jitter) continue;
    ++found;
    sum += *l.jitter;
    squares += std::pow((*l.jitter - 0.05) / l.jitter_error, 2);
  }
  std::cout << "jitter 0.05 frames: mean " << sum / found << ", reduced chi^2 " << squares / found << "\n";
  EXPECT_EQ(found, trials);
  EXPECT_NEAR(sum / found, 0.05, 0.002);
  EXPECT_GT(squares / found, 0.5);
  EXPECT_LT(squares / found, 2);
  const DriveFit still = fit_drive(heights_of({}, generator));
  EXPECT_LT(still.jitter_limit, 0.02);
}

TEST(DriveFit, DroppedAndDoubledFramesAreFoundAndMended) {
  std::mt19937_64 generator(5);
  std::vector<double> h = heights_of({.frames = 300}, generator);
  h.erase(h.begin() + 100);           // dropped
  h.insert(h.begin() + 200, h[199]);  // duplicated
  const DriveFit l = fit_drive(h);
  EXPECT_EQ(l.dropped, 1);
  EXPECT_EQ(l.doubled, 1);
  EXPECT_NEAR(l.amplitude, 12, 5 * l.amplitude_error);
  EXPECT_NEAR(l.period, 20, 5 * l.period_error);
  EXPECT_EQ(l.out_of_lock, 0);
  EXPECT_EQ(l.frames[100].tick - l.frames[99].tick, 2);
}

// A long gap in a short stack is one place, not a slip in each cycle (before: a period of 18.7 frames).
// Fits of another number of frames per cycle follow such a plate too, by a slip in each cycle.
TEST(DriveFit, LostFramesOfARattlingPlateAreFound) {
  const std::vector<std::vector<int>> lost = {{}, {91}, {37, 38, 91, 120}};
  std::mt19937_64 generator(12);
  for (int trial = 0; trial < 10; ++trial)
    for (const std::vector<int>& gone : lost)
      for (const int twice : {0, 1})
        for (const int stated : {0, 20}) {
          std::vector<double> all =
              heights_of({.amplitude = 3, .phi = 0.3 * trial, .noise = 0.1, .frames = 160}, generator);
          std::vector<double> h;
          for (int f = 0; f < 160; ++f) {
            if (std::find(gone.begin(), gone.end(), f) != gone.end()) continue;
            h.push_back(all[static_cast<std::size_t>(f)]);
            if (twice == 1 && f == 60) h.push_back(h.back() + 0.02);
          }
          const DriveFit l = fit_drive(h, {.frames_per_cycle = stated});
          SCOPED_TRACE(std::to_string(gone.size()) + " lost, " + std::to_string(twice) +
                       " taken twice, stated " + std::to_string(stated) + ", trial " + std::to_string(trial));
          EXPECT_EQ(l.frames_per_cycle, 20);
          EXPECT_EQ(l.dropped, static_cast<std::int64_t>(gone.size()));
          EXPECT_EQ(l.doubled, twice);
          EXPECT_NEAR(l.amplitude, 3, 0.1);
        }
}

// Few frames follow the lost one, so that the fit turns towards them, and rounding errors that recur hide
// that their residuals persist.
TEST(DriveFit, AFrameThatIsLostNearTheEndIsFound) {
  std::vector<double> h;
  for (int f = 0; f < 160; ++f) {
    const double rounding = 0.13 * std::cos(2 * kPi * 9 * f / 20.0);
    if (f != 152) h.push_back(3 * std::sin(2 * kPi * f / 20.0) + rounding);
  }
  const DriveFit l = fit_drive(h, {.frames_per_cycle = 0, .mend = true, .model_error = 0.03});
  EXPECT_EQ(l.dropped, 1);
  EXPECT_EQ(l.doubled, 0);
  EXPECT_EQ(l.frames.back().tick, 159);
}

TEST(DriveFit, OneLongGapIsFound) {
  for (const std::size_t missing : {std::size_t{7}, std::size_t{13}}) {
    std::mt19937_64 generator(5);
    std::vector<double> h = heights_of({.frames = 160}, generator);
    h.erase(h.begin() + 80, h.begin() + 80 + static_cast<std::ptrdiff_t>(missing));
    const DriveFit l = fit_drive(h);
    EXPECT_EQ(l.dropped, static_cast<std::int64_t>(missing));
    EXPECT_EQ(l.frames_per_cycle, 20) << missing;
    EXPECT_NEAR(l.amplitude, 12, 5 * l.amplitude_error) << missing;
    EXPECT_EQ(l.frames[80].tick - l.frames[79].tick, 1 + static_cast<double>(missing));
  }
}

TEST(DriveFit, FramesOutOfLockAreFlagged) {
  std::mt19937_64 generator(6);
  std::vector<double> h = heights_of({}, generator);
  for (const std::size_t f : {std::size_t{17}, std::size_t{90}, std::size_t{150}}) h[f] += 3;
  const DriveFit l = fit_drive(h);
  EXPECT_EQ(l.out_of_lock, 3);
  EXPECT_EQ(l.frames[90].lock, FrameLock::out_of_lock);
  EXPECT_NEAR(l.frames[90].residual, 3, 0.3);
}

TEST(DriveFit, FramesInWhichThePlateRestsHaveNoPhase) {
  std::mt19937_64 generator(6);
  for (const bool before : {true, false}) {
    std::vector<double> h = heights_of({.phi = 0}, generator);
    const std::vector<double> rest = heights_of({.amplitude = 0, .frames = 60}, generator);
    h.insert(before ? h.begin() : h.end(), rest.begin(), rest.end());
    const DriveFit l = fit_drive(h);
    ASSERT_EQ(l.out_of_lock_stretches.size(), 1U) << before;
    EXPECT_NEAR(static_cast<double>(imaging::frames_in(l.out_of_lock_stretches)), 60, 2) << before;
    EXPECT_FALSE(l.has_phase(before ? 10 : h.size() - 10)) << "where the sine crosses the plate at rest";
    EXPECT_TRUE(l.has_phase(130));
    EXPECT_TRUE(std::any_of(l.notes.begin(), l.notes.end(), [](const std::string& note) {
      return note.find("does not follow the drive in") != std::string::npos;
    })) << before;
  }
  std::vector<double> misread = heights_of({}, generator);
  misread[90] += 3;
  EXPECT_TRUE(fit_drive(misread).has_phase(90)) << "a plate does not stop for one frame";
  EXPECT_TRUE(fit_drive(misread).notes.empty());
}

TEST(DriveFit, FramesThatAreRepeatedToTheBitDoNotSpoilThePeriod) {
  std::mt19937_64 generator(9);
  const std::vector<double> each = heights_of({.frames = 100}, generator);
  std::vector<double> h;
  std::vector<std::uint8_t> repeats;
  for (std::size_t f = 0; f < each.size(); ++f)
    for (int copy = 0; copy < (f % 5 == 4 ? 2 : 1); ++copy) {
      h.push_back(each[f]);
      repeats.push_back(copy == 0 ? 0 : 1);
    }
  const DriveFit l = fit_drive(h, {.repeats = repeats});
  EXPECT_EQ(l.frames_per_cycle, 20);
  EXPECT_EQ(l.doubled, 20);
  ASSERT_EQ(l.frames.size(), h.size());
  EXPECT_EQ(l.frames[5].cycles, l.frames[4].cycles);
  EXPECT_NEAR(l.frames[6].cycles - l.frames[5].cycles, 1.0 / 20, 1e-4);
  ASSERT_FALSE(l.notes.empty());
  EXPECT_NE(l.notes.front().find("20 of 120 frames equal the frame before them"), std::string::npos);
}

TEST(DriveFit, AWrongNumberOfFramesPerCycleIsNoPlateAtRest) {
  std::mt19937_64 generator(8);
  const std::vector<double> h = heights_of({.period = 20.5, .frames = 123}, generator);
  expect_refusal<InputError>([&] { (void)fit_drive(h, {.frames_per_cycle = 41}); }, "moves by 12",
                             "a period of 20.5 frames, but 41 frames per cycle are stated",
                             "camera.frames_per_cycle");
  expect_refusal<InputError>(
      [&] { (void)fit_drive(heights_of({.amplitude = 0}, generator), {.frames_per_cycle = 20}); },
      "does not move by more than the scatter");
}

TEST(DriveFit, HeightsWithoutADriveAreRefused) {
  EXPECT_THROW(fit_drive({1, 2, 3}), InputError);
  EXPECT_THROW(fit_drive(std::vector<double>(50, 4.0)), InputError) << "a plate at rest has no phase";
  EXPECT_THROW(fit_drive(std::vector<double>(50, std::nan(""))), InputError);
  std::mt19937_64 generator(7);
  EXPECT_THROW(fit_drive(heights_of({.amplitude = 0}, generator)), InputError);
  // Four phases per cycle do not determine a second harmonic.
  const DriveFit coarse = fit_drive(heights_of({.period = 4}, generator));
  EXPECT_NEAR(coarse.amplitude, 12, 5 * coarse.amplitude_error);
  EXPECT_FALSE(coarse.second_harmonic.has_value());
}

TEST(DriveFit, AnAccelerometerIsFittedTheSameWay) {
  VibrationTable t{.file = "a.csv", .time_s = {}, .acceleration = {}};
  for (int i = 0; i < 500; ++i) {
    t.time_s.push_back(10 + i * 1e-3);
    t.acceleration.push_back(0.3 - 25 * std::sin(2 * kPi * 23.4 * t.time_s.back()));
  }
  const VibrationFit v = fit_vibration(t);
  EXPECT_NEAR(v.frequency_hz, 23.4, 1e-6);
  EXPECT_NEAR(v.acceleration, 25, 1e-6);
  EXPECT_TRUE(v.doubts.empty());
  VibrationTable overloaded = t;
  for (double& a : overloaded.acceleration) a = std::clamp(a, -20.0, 20.0);
  const std::vector<std::string> doubts = fit_vibration(overloaded).doubts;
  ASSERT_EQ(doubts.size(), 1U);
  const std::string begins = "acceleration_m_s2 of a.csv: ";
  ASSERT_TRUE(doubts[0].starts_with(begins)) << doubts[0];
  // 2 arccos(0.8)/pi = 41 % of a sine
  EXPECT_NEAR(std::stod(doubts[0].substr(begins.size())), 41, 2) << doubts[0];
  expect_refusal<InputError>(
      [] {
        (void)fit_vibration({.file = "a.csv", .time_s = {0, 1}, .acceleration = {1, 2}});
      },
      "a.csv: acceleration_m_s2: holds 2 values");
  t.time_s[100] = 3;
  EXPECT_THROW(fit_vibration(t), InputError);
}

}  // namespace twincell::drive_fit_test
