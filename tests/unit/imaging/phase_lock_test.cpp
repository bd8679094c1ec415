// Phases from a fixed number per cycle, from a list, and from the motion of the bed.
#include "imaging/phase/phase_lock.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "core/error.hpp"
#include "imaging/phase/phase_estimation.hpp"
#include "imaging/phase/trigger_list.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::phase_lock_test {

using namespace imaging;

namespace {

constexpr int kPhases = 20;

/// Height of an inelastic bed at any fraction of a cycle.
double bed_height(double gamma, double cycles) {
  static const auto fine = [](double g) { return inelastic_bed(g, 2000); };
  static const std::vector<double> two = fine(2.0);
  EXPECT_EQ(gamma, 2.0);
  const double at = (cycles - std::floor(cycles)) * 2000;
  const auto i = static_cast<std::size_t>(at) % 2000;
  return two[i] + (two[(i + 1) % 2000] - two[i]) * (at - std::floor(at));
}

/// A recording of a bed: the true phases, and heights with noise.
struct Film {
  std::vector<std::int64_t> ticks;
  std::vector<double> heights;
};

Film film(int frames, int first_phase, double noise, double jitter, const std::vector<int>& drop_before,
          const std::vector<int>& doubled) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  Film out;
  std::int64_t tick = first_phase;
  for (int f = 0; f < frames; ++f) {
    if (f > 0 && std::find(doubled.begin(), doubled.end(), f) == doubled.end()) ++tick;
    tick += std::count(drop_before.begin(), drop_before.end(), f);
    out.ticks.push_back(tick);
    const double when = (static_cast<double>(tick) + jitter * normal(generator)) / kPhases;
    // A slow rise is added, as of a bed that dilates.
    out.heights.push_back(bed_height(2.0, when) + noise * normal(generator) + 0.3 * std::sin(0.003 * f));
  }
  return out;
}

std::string write_list(const TemporaryFolder& folder, const std::string& text) {
  const std::string path = folder / "triggers.csv";
  std::ofstream(path) << text;
  return path;
}

}  // namespace

TEST(PhaseLock, FramesToPhasesAndCycles) {
  const PhaseLock lock{20, 13};
  EXPECT_EQ(lock.phase(0), 13);
  EXPECT_EQ(lock.cycle(0), 0);
  EXPECT_EQ(lock.phase(6), 19);
  EXPECT_EQ(lock.phase(7), 0);
  EXPECT_EQ(lock.cycle(7), 1);
  EXPECT_DOUBLE_EQ(lock.fraction(12), 0.25);
  EXPECT_EQ(lock.phase(20LL * 1'000'000'000'000 + 1), 14);
  EXPECT_EQ(PhaseLock{}.phase(5), -1);
  EXPECT_EQ(PhaseLock{}.cycle(5), -1);
  EXPECT_THROW((PhaseLock{20, 20}.check({})), ConfigError);
  EXPECT_THROW((PhaseLock{-1, 0}.check({})), ConfigError);
  const PhaseTable table = fixed_phases(lock);
  EXPECT_EQ(table.method, PhaseMethod::fixed);
  EXPECT_EQ(table.at(7).phase, 0);
  EXPECT_EQ(table.at(7).cycle, 1);
  EXPECT_FALSE(table.jitter.has_value()) << "nothing was measured";
}

TEST(TriggerList, PhasesJitterDroppedAndDoubled) {
  const TemporaryFolder folder;
  // 10 Hz drive, 20 phases: 5 ms apart. Frame 3 comes 0.5 ms late, one frame is missing before frame 5, and
  // frame 7 is recorded twice.
  const auto path =
      write_list(folder,
                 "frame,time_s\n0,0.090\n1,0.095\n2,0.100\n3,0.1055\n4,0.110\n5,0.120\n6,0.125\n"
                 "7,0.1252\n8,0.130\n");
  const PhaseTable t = read_triggers(path, 10);
  EXPECT_EQ(t.frames_per_cycle, 20);
  EXPECT_EQ(t.first_phase, 18);
  std::vector<std::int32_t> phases;
  std::vector<std::int64_t> cycles;
  std::vector<double> intervals;
  for (const FramePhase& f : t.frames) {
    phases.push_back(f.phase);
    cycles.push_back(f.cycle);
    intervals.push_back(f.interval);
  }
  EXPECT_EQ(phases, (std::vector<std::int32_t>{18, 19, 0, 1, 2, 4, 5, 5, 6}));
  EXPECT_EQ(cycles, (std::vector<std::int64_t>{0, 0, 1, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(intervals, (std::vector<double>{1, 1, 1, 1, 1, 2, 1, 0, 1}));
  EXPECT_EQ(t.dropped, 1);
  EXPECT_EQ(t.doubled, 1);
  // Lateness of the frames: 0.1, 0.04 and seven times 0, of which the mean is no jitter.
  EXPECT_NEAR(t.offset, 0.14 / 9, 1e-4);
  EXPECT_NEAR(t.jitter.value(), std::sqrt((0.1 * 0.1 + 0.04 * 0.04) / 9 - std::pow(0.14 / 9, 2)), 1e-6);
}

TEST(TriggerList, ACommonDelayIsAnOffsetAndNoJitter) {
  for (const double late : {0.3, 0.49, 0.5, -0.2}) {
    const TemporaryFolder folder;
    std::string text = "cycles\n";
    // Alternately 0.01 frames early and late.
    for (int f = 0; f < 60; ++f)
      text += std::to_string((100 + f + late + (f % 2 == 0 ? 0.01 : -0.01)) / 20.0) + "\n";
    const PhaseTable t = read_triggers(write_list(folder, text), std::nullopt, 20);
    EXPECT_NEAR(std::remainder(t.offset - late, 1), 0, 1e-4) << late;
    EXPECT_NEAR(t.jitter.value(), 0.01, 1e-4) << late;
    EXPECT_EQ(t.dropped + t.doubled, 0) << late;
  }
}

TEST(TriggerList, AFrameWithoutATimeHasNoPhase) {
  const TemporaryFolder folder;
  // Seven frames before the shaker starts, and two in a pause; the camera lost a frame after frame 14.
  std::string text = "frame,cycles\n";
  for (int f = 0; f < 60; ++f) {
    const bool rests = f < 7 || f == 30 || f == 31;
    text += std::to_string(f) + "," + (rests ? "" : std::to_string(2 + (f + (f > 14 ? 1 : 0)) / 20.0)) + "\n";
  }
  const PhaseTable t = read_triggers(write_list(folder, text), std::nullopt);
  EXPECT_EQ(t.frames_per_cycle, 20);
  EXPECT_EQ(t.first_phase, 7);
  EXPECT_EQ(t.dropped, 1);
  EXPECT_EQ(t.doubled, 0);
  EXPECT_EQ(t.out_of_lock, (std::vector<FrameStretch>{{0, 6}, {30, 31}}));
  EXPECT_NE(t.warning.find("9 of 60 frames (0 to 6 and 30 to 31)"), std::string::npos) << t.warning;
  for (const int f : {0, 6, 30, 31}) {
    EXPECT_EQ(t.at(f).phase, -1) << f;
    EXPECT_FALSE(t.is_used(f)) << f;
    EXPECT_FALSE(t.cycles_at(f)) << f;
  }
  EXPECT_EQ(t.at(7).phase, 7);
  EXPECT_EQ(t.at(7).cycle, 0);
  EXPECT_EQ(t.at(32).phase, 13);
  EXPECT_EQ(t.at(32).cycle, 1);
  EXPECT_TRUE(t.is_used(32));
  expect_refusal<InputError>(
      [&] { (void)read_triggers(write_list(folder, "frame,cycles\n0,\n1,\n"), std::nullopt); },
      "is empty in all lines");
  EXPECT_THROW(read_triggers(write_list(folder, "cycles,x\n0,1\n,1\n"), std::nullopt), InputError)
      << "without frame numbers a missing time may be a damaged line";
}

TEST(TriggerList, APeriodThatIsNoWholeNumberOfFramesDropsNone) {
  const TemporaryFolder folder;
  for (const double period : {20.5, 19.95, 13.0 + 1.0 / 3, 7.2, 20.8, 100.4}) {
    std::string text = "cycles\n";
    const int frames = static_cast<int>(20 * period);
    for (int f = 0; f < frames; ++f) text += fmt::format("{:.6f}\n", (f + 5) / period);
    const PhaseTable t = read_triggers(write_list(folder, text), std::nullopt);
    ASSERT_TRUE(t.period_frames) << period;
    EXPECT_NEAR(*t.period_frames, period, 1e-4) << period;
    EXPECT_EQ(t.dropped + t.doubled, 0) << period;
    EXPECT_EQ(t.frames_per_cycle, static_cast<int>(period + 0.1)) << period;
    EXPECT_EQ(t.warning, "") << period;
    std::set<std::pair<std::int64_t, std::int32_t>> seen;
    std::int64_t between = 0;
    for (int f = 0; f < frames; ++f) {
      ASSERT_TRUE(t.cycles_at(f)) << period << ' ' << f;
      EXPECT_NEAR(*t.cycles_at(f), (f + 5) / period, 1e-6) << period << ' ' << f;
      EXPECT_TRUE(t.is_used(f));
      const FramePhase at = t.at(f);
      EXPECT_EQ(at.interval, 1) << period << ' ' << f;
      between += at.phase < 0 ? 1 : 0;
      if (at.phase < 0) continue;
      EXPECT_TRUE(seen.emplace(at.cycle, at.phase).second) << period << ": two frames at one phase";
      const double off = (static_cast<double>(at.cycle) + static_cast<double>(at.phase) / t.frames_per_cycle -
                          (f + 5) / period) *
                         t.frames_per_cycle;
      EXPECT_LE(std::abs(off), 0.5001) << period << ' ' << f;
    }
    EXPECT_EQ(between, t.between) << period;
    EXPECT_LE(between, frames / static_cast<int>(period) + 1) << period;
    // Every phase of every whole cycle has its frame, unless the period is a little below N_k.
    if (t.frames_per_cycle > period) continue;
    for (std::int64_t j = 1; j < 19; ++j)
      for (std::int32_t k = 0; k < t.frames_per_cycle; ++k)
        EXPECT_TRUE(seen.contains({j, k})) << period << ' ' << j << ' ' << k;
  }
}

TEST(TriggerList, LostFramesOfAnUnevenPeriodAreCounted) {
  const TemporaryFolder folder;
  std::string text = "cycles\n";
  for (int f = 0; f < 246; ++f)
    if (f != 50 && f != 51 && f != 120)
      text += fmt::format("{:.6f}\n", f / 20.5) + (f == 200 ? fmt::format("{:.6f}\n", f / 20.5) : "");
  const PhaseTable t = read_triggers(write_list(folder, text), std::nullopt);
  EXPECT_EQ(t.dropped, 3);
  EXPECT_EQ(t.doubled, 1);
  EXPECT_NEAR(*t.period_frames, 20.5, 1e-4);
  EXPECT_FALSE(t.is_used(198)) << "the second of the two frames at one instant";
}

TEST(TriggerList, StatedFramesPerCycleThatTheListContradictsAreNamed) {
  const TemporaryFolder folder;
  std::string text = "cycles\n";
  for (int f = 0; f < 123; ++f) text += fmt::format("{:.6f}\n", f / 20.5);
  const PhaseTable t = read_triggers(write_list(folder, text), std::nullopt, 41);
  EXPECT_EQ(t.frames_per_cycle, 20);
  EXPECT_EQ(t.dropped, 0);
  EXPECT_NE(t.warning.find("41 frames per cycle are stated, but the frames are 20.5 per cycle"),
            std::string::npos)
      << t.warning;
}

TEST(TriggerList, RefusesWhatIsNone) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_triggers(folder / "no.csv", 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, ""), 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, "frame,x\n0,1\n"), 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, "frame,time_s\n0,0\n1,nan\n"), 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, "frame,time_s\n0,0\n2,0.1\n"), 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, "frame,time_s\n0,0.2\n1,0.1\n"), 10), InputError);
  EXPECT_THROW(read_triggers(write_list(folder, "frame,time_s\n0,0\n1,0.1\n"), std::nullopt), ConfigError);
  EXPECT_THROW(read_triggers(write_list(folder, "cycles\n0.5\n"), std::nullopt), InputError) << "no step";
  EXPECT_EQ(read_triggers(write_list(folder, "cycles\n0.5\n"), std::nullopt, 20).frames[0].phase, 10);
}

TEST(FoundPhase, TheBedOnThePlateIsThatOfItsEquation) {
  // The bed is on the plate while Gamma sin(t) <= 1, so that it takes off at asin(1/2) = 1/12 of a cycle and
  // then follows a parabola.
  const auto bed = inelastic_bed(2.0, 240);
  constexpr double kTau = 2 * std::numbers::pi;
  double worst = 0;
  for (std::size_t k = 0; k < 240; ++k) {
    const double t = kTau * static_cast<double>(k) / 240, take_off = kTau / 12;
    const double flight = t - take_off;
    const double parabola = 0.5 + std::sqrt(0.75) * flight - 0.25 * flight * flight;
    const double expected = k <= 20 || parabola < std::sin(t) ? std::sin(t) : parabola;
    worst = std::max(worst, std::abs(bed[k] - expected));
  }
  std::cout << "largest departure from the closed form " << worst << " A\n";
  EXPECT_LE(worst, 1e-3);
}

TEST(FoundPhase, PhasesAndWhatIsWrongWithThem) {
  const Film clean = film(400, 7, 0.01, 0, {}, {});
  const PhaseTable t = estimate_phases({clean.heights, {}}, {.frames_per_cycle = 0, .gamma = 2.0});
  EXPECT_EQ(t.frames_per_cycle, kPhases);
  EXPECT_NEAR(t.period_frames.value(), kPhases, 0.005);
  EXPECT_EQ(t.dropped, 0);
  EXPECT_EQ(t.doubled, 0);
  EXPECT_GE(t.agreement.value(), 0.99);
  EXPECT_LE(t.jitter.value(), 0.03);
  for (std::size_t f = 0; f < clean.ticks.size(); ++f)
    ASSERT_EQ(t.frames[f].phase, clean.ticks[f] % kPhases) << f;

  const Film bad = film(600, 7, 0.01, 0, {83, 210, 211, 415}, {140, 333});
  const PhaseTable u = estimate_phases({bad.heights, {}}, {.frames_per_cycle = 0, .gamma = 2.0});
  EXPECT_EQ(u.dropped, 4);
  EXPECT_EQ(u.doubled, 2);
  std::size_t wrong = 0;
  for (std::size_t f = 0; f < bad.ticks.size(); ++f)
    wrong +=
        u.frames[f].phase != bad.ticks[f] % kPhases || u.frames[f].cycle != bad.ticks[f] / kPhases ? 1 : 0;
  std::cout << wrong << " of 600 frames in the wrong phase\n";
  EXPECT_LE(wrong, 12U) << "a slip may be placed a frame early or late";
}

TEST(FoundPhase, ThreeCyclesAreEnoughAndASlipThatIsSoonUndoneIsSeen) {
  for (const bool beads_tell : {false, true}) {
    const Film bad = film(60, 0, beads_tell ? 0.01 : 0.003, 0, {23}, {35});
    BedMotion motion{bad.heights, {}};
    if (beads_tell) {
      motion.repeats.assign(60, -40.0);
      motion.repeats[35] = 40;
    }
    const PhaseTable t = estimate_phases(motion, {.frames_per_cycle = 0, .gamma = 2.0});
    EXPECT_EQ(t.frames_per_cycle, kPhases);
    EXPECT_EQ(t.dropped, 1);
    EXPECT_EQ(t.doubled, 1);
  }
}

TEST(FoundPhase, GapsInEverySecondCycleHideNoPeriod) {
  for (const int more : {2, 3}) {
    std::vector<int> dropped(static_cast<std::size_t>(more), 41);
    dropped.insert(dropped.end(), static_cast<std::size_t>(more), 82);
    const Film bad = film(114, 0, 0.01, 0, dropped, {});
    const PhaseTable t = estimate_phases({bad.heights, {}}, {.frames_per_cycle = 0, .gamma = 2.0});
    EXPECT_EQ(t.frames_per_cycle, kPhases);
    EXPECT_EQ(t.dropped, 2 * more);
    EXPECT_EQ(t.doubled, 0);
  }
}

TEST(FoundPhase, AGapOfHalfACycleIsSeen) {
  const Film bad = film(110, 3, 0.01, 0, std::vector<int>(10, 47), {});
  const PhaseTable t = estimate_phases({bad.heights, std::vector<double>(bad.heights.size(), -40.0)},
                                       {.frames_per_cycle = 0, .gamma = 2.0});
  EXPECT_EQ(t.frames_per_cycle, kPhases);
  EXPECT_EQ(t.dropped, 10);
  EXPECT_EQ(t.doubled, 0);
  for (std::size_t f = 0; f < bad.ticks.size(); ++f)
    EXPECT_EQ(t.frames[f].phase, bad.ticks[f] % kPhases) << f;
}

TEST(FoundPhase, RepeatsSeenByTheBeadsAreEvidence) {
  // A bed with irregular motion, as above the onset of convection.
  const Film clean = film(240, 0, 0.05, 0, {}, {});
  BedMotion motion{clean.heights, std::vector<double>(clean.heights.size(), -40.0)};
  const PhaseEstimationOptions options{.frames_per_cycle = kPhases, .gamma = 2.0};
  EXPECT_EQ(estimate_phases(motion, options).doubled, 0);
  // At the turning point of the bed successive frames look alike in every cycle: no frame was recorded twice.
  for (std::size_t f = 9; f < motion.repeats.size(); f += kPhases) motion.repeats[f] = 40;
  EXPECT_EQ(estimate_phases(motion, options).doubled, 0);
  // A repeat that occurs only once in the recording is a doubled frame.
  const Film twice = film(240, 0, 0.05, 0, {}, {114});
  BedMotion seen{twice.heights, std::vector<double>(twice.heights.size(), -40.0)};
  seen.repeats[114] = 40;
  const PhaseTable t = estimate_phases(seen, options);
  EXPECT_EQ(t.doubled, 1);
  EXPECT_EQ(t.frames[114].interval, 0);
}

TEST(FoundPhase, OddsOfARepeat) {
  const double nan = std::nan("");
  EXPECT_EQ(log_odds_of_repeat({}), 0);
  EXPECT_EQ(log_odds_of_repeat(std::vector<double>{nan, nan}), 0);
  EXPECT_EQ(log_odds_of_repeat(std::vector<double>{0.5}), 3) << "one bead tells little";
  EXPECT_EQ(log_odds_of_repeat(std::vector<double>{5}), -27) << "but more if it moved";
  std::vector<double> many(200, 1.0);
  EXPECT_EQ(log_odds_of_repeat(many), 40);
  std::fill_n(many.begin(), 18, 30.0);
  EXPECT_EQ(log_odds_of_repeat(many), 40) << "some wrong links do no harm";
  std::fill_n(many.begin(), 40, 30.0);
  EXPECT_EQ(log_odds_of_repeat(many), -40);
}

TEST(FoundPhase, APeriodThatIsNoWholeNumberOfFramesIsMeasured) {
  std::vector<double> heights;
  for (int f = 0; f < 200; ++f) heights.push_back(bed_height(2.0, f / 20.03));
  EXPECT_NEAR(estimate_phases({heights, {}}, {.frames_per_cycle = 0, .gamma = 2.0}).period_frames.value(),
              20.03, 0.006);
}

TEST(FoundPhase, JitterIsMeasured) {
  for (const double jitter : {0.1, 0.25}) {
    const Film f = film(2000, 0, 0.005, jitter, {}, {});
    const PhaseTable t = estimate_phases({f.heights, {}}, {.frames_per_cycle = 0, .gamma = 2.0});
    std::cout << "jitter " << jitter << ", found " << t.jitter.value() << '\n';
    EXPECT_EQ(t.dropped + t.doubled, 0);
    EXPECT_NEAR(t.jitter.value(), jitter, 0.25 * jitter);
  }
}

TEST(FoundPhase, WithoutADriveTheFundamentalIsTheClock) {
  std::vector<double> sine;
  for (int f = 0; f < 200; ++f) sine.push_back(std::sin(2 * std::numbers::pi * (f + 5) / 25));
  const PhaseTable t = estimate_phases({sine, {}}, {});
  EXPECT_EQ(t.frames_per_cycle, 25);
  EXPECT_EQ(t.first_phase, 5);
  EXPECT_FALSE(t.agreement.has_value());
}

TEST(FoundPhase, RefusesWhatDoesNotRepeat) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> walk = {0};
  for (int f = 1; f < 500; ++f) walk.push_back(walk.back() + normal(generator));
  EXPECT_THROW(estimate_phases({walk, {}}, {}), InputError);
  EXPECT_THROW(estimate_phases({std::vector<double>(500, 1.0), {}}, {}), InputError);
  EXPECT_THROW(estimate_phases({std::vector<double>(5, 1.0), {}}, {}), InputError);
  const Film f = film(400, 0, 0.01, 0, {}, {});
  EXPECT_THROW(estimate_phases({f.heights, {}}, {.frames_per_cycle = 13, .gamma = {}}), InputError);
  EXPECT_THROW(estimate_phases({f.heights, {}}, {.frames_per_cycle = 2, .gamma = {}}), InputError);
}

TEST(FoundPhase, ABedAtRestIsSaidToBeAtRest) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.002);
  for (const bool noisy : {false, true})
    for (const int given : {0, kPhases}) {
      std::vector<double> heights(100, 0.0);
      if (noisy)
        for (double& h : heights) h = noise(random);
      expect_refusal<InputError>(
          [&] {
            (void)estimate_phases({heights, {}}, {.frames_per_cycle = given, .gamma = {}});
          },
          "the bed is at rest");
    }
  // A bed that moves without a period is not at rest.
  std::vector<double> heights(100);
  for (double& h : heights) h = 100 * noise(random);
  EXPECT_EQ(complaint_of([&] {
              (void)estimate_phases({heights, {}}, {.frames_per_cycle = kPhases, .gamma = {}});
            }).find("at rest"),
            std::string::npos);
}

}  // namespace twincell::phase_lock_test
