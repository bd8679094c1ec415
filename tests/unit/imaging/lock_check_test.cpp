// A stated phase lock against plate, time stamps and bed: dropped and doubled frames are found where they
// are, intact stacks are left alone, and what cannot be checked is said.
#include "imaging/phase/lock_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/error.hpp"
#include "imaging/phase/dropped_frames.hpp"
#include "imaging/phase/phases_of_times.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::lock_check_test {

using namespace imaging;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

struct Film {
  int frames_per_cycle = 20, frames = 100, first_phase = 0;
  double period = 20;     ///< of the drive, frames
  double amplitude = 12;  ///< px
  double noise = 0.3, jitter = 0;
  std::vector<int> drop, twice = {};  ///< numbers in the film without faults
};

/// Ticks of the frames that are left.
std::vector<std::int64_t> ticks_of(const Film& film) {
  std::vector<std::int64_t> ticks;
  for (int f = 0; f < film.frames; ++f) {
    if (std::find(film.drop.begin(), film.drop.end(), f) != film.drop.end()) continue;
    ticks.push_back(f);
    if (std::find(film.twice.begin(), film.twice.end(), f) != film.twice.end()) ticks.push_back(f);
  }
  return ticks;
}

std::vector<double> plate_of(const Film& film, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> heights;
  for (const std::int64_t t : ticks_of(film))
    heights.push_back(
        40 + film.noise * normal(generator) +
        film.amplitude *
            std::sin(kTurn * (static_cast<double>(t + film.first_phase) + film.jitter * normal(generator)) /
                     film.period));
  return heights;
}

/// A bed that an inelastic plate throws; `spread`: scatter of its flights from cycle to cycle, cycles.
BedMotion bed_of(const Film& film, double gamma, double spread, unsigned seed) {
  constexpr int kFine = 500;
  static std::map<double, std::vector<double>> beds;
  if (!beds.contains(gamma)) beds[gamma] = inelastic_bed(gamma, kFine);
  const std::vector<double>& fine = beds[gamma];
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> late(1000);
  for (double& l : late) l = spread * normal(generator);
  BedMotion motion;
  for (const std::int64_t t : ticks_of(film)) {
    const double cycles = static_cast<double>(t + film.first_phase) / film.period;
    const double at = cycles - std::floor(cycles) + late[static_cast<std::size_t>(cycles)];
    const auto i = static_cast<std::size_t>((at - std::floor(at)) * kFine) % kFine;
    motion.heights.push_back(fine[i] + 0.002 * normal(generator));
  }
  return motion;
}

/// Number of frames whose phase and cycle are those of the film without faults.
std::size_t right(const PhaseTable& table, const Film& film) {
  const std::vector<std::int64_t> ticks = ticks_of(film);
  std::size_t n = 0;
  for (std::size_t f = 0; f < ticks.size(); ++f) {
    const FramePhase at = table.at(static_cast<std::int64_t>(f));
    n += at.cycle * film.frames_per_cycle + at.phase == ticks[f] + film.first_phase ? 1 : 0;
  }
  return n;
}

PhaseTable checked(const Film& film, unsigned seed) {
  return check_lock({film.frames_per_cycle, film.first_phase},
                    {.plate_px = plate_of(film, seed), .times_s = {}});
}

}  // namespace

TEST(LockCheck, ThePlateShowsWhereFramesAreMissing) {
  // Everywhere in a cycle, also at the plate's turning points, and several in a row and in one film.
  for (int at = 20; at < 60; ++at)
    for (int row = 1; row <= 3; ++row) {
      Film film{.first_phase = 7, .drop = {}};
      for (int k = 0; k < row; ++k) film.drop.push_back(at + k);
      const PhaseTable table = checked(film, static_cast<unsigned>(at));
      EXPECT_EQ(table.dropped, row) << at;
      EXPECT_EQ(table.doubled, 0) << at;
      EXPECT_EQ(table.checked_by, "the plate");
      // Next to a turning point the frame may be one early or late.
      EXPECT_GE(right(table, film), ticks_of(film).size() - 3) << at;
      EXPECT_NE(table.warning.find(std::to_string(row) + " before frame "), std::string::npos)
          << table.warning;
    }
  const Film many{.drop = {17, 40, 61}};
  EXPECT_EQ(checked(many, 1).dropped, 3);
  EXPECT_GE(right(checked(many, 1), many), ticks_of(many).size() - 3);
  const Film twice{.drop = {}, .twice = {33}};
  EXPECT_EQ(checked(twice, 1).doubled, 1);
}

TEST(LockCheck, IntactStacksAreLeftAlone) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const int n = std::array{12, 20, 48, 80}[seed % 4];
    const PhaseTable table = checked({.frames_per_cycle = n,
                                      .frames = 6 * n,
                                      .period = static_cast<double>(n),
                                      .amplitude = std::array{4.0, 12.0, 30.0}[seed % 3],
                                      .noise = 0.3,
                                      .jitter = std::array{0.0, 0.1, 0.2}[seed / 4 % 3],
                                      .drop = {}},
                                     seed);
    EXPECT_EQ(table.checked_by, "the plate") << seed;
    EXPECT_TRUE(table.frames.empty()) << seed << ": " << table.warning;
    EXPECT_EQ(table.warning, "") << seed;
  }
}

TEST(LockCheck, AnotherPeriodIsRefusedWithTheDriftAndTheCure) {
  try {
    (void)checked({.period = 24, .drop = {}}, 1);
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find("repeats itself after 24.0"), std::string::npos) << said;
    EXPECT_NE(said.find("drift by "), std::string::npos) << said;
    EXPECT_NE(said.find("--phase-lock found"), std::string::npos) << said;
  }
}

TEST(LockCheck, AnotherFirstPhaseIsNamed) {
  const std::vector<double> plate = plate_of({.first_phase = 9, .drop = {}}, 1);
  // One frame is that of a count that begins with 1. A camera may lag behind the stated phase by half a
  // frame.
  EXPECT_NE(complaint_of([&] {
              (void)check_lock({20, 8}, {.plate_px = plate, .times_s = {}});
            }).find("first_phase: is 8, but the plate in the frames shows the first frame at phase 9 of 20"),
            std::string::npos);
  EXPECT_EQ(check_lock({20, 9}, {.plate_px = plate, .times_s = {}}).warning, "");
  try {
    (void)check_lock({20, 3}, {.plate_px = plate, .times_s = {}});
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    const std::string said = e.what();
    EXPECT_NE(
        said.find("first_phase: is 3, but the plate in the frames shows the first frame at phase 9 of 20"),
        std::string::npos)
        << said;
  }
}

TEST(LockCheck, FramesWithThePlateAtRestAreExcludedWithANote) {
  for (const std::size_t rest : {20U, 40U, 60U})
    for (const bool before : {true, false})
      for (unsigned seed = 0; seed < 5; ++seed) {
        std::vector<double> plate = plate_of({.frames = 200, .drop = {}}, seed);
        plate.insert(before ? plate.begin() : plate.end(), rest, 40.0);
        const PhaseTable table = check_lock({20, 0}, {.plate_px = plate, .times_s = {}});
        EXPECT_EQ(table.checked_by, "the plate");
        EXPECT_EQ(table.dropped + table.doubled, 0) << rest << ' ' << before << ": " << table.warning;
        EXPECT_NEAR(static_cast<double>(frames_in(table.out_of_lock)), static_cast<double>(rest), 2);
        EXPECT_NE(table.warning.find("does not follow the drive in"), std::string::npos) << table.warning;
        EXPECT_FALSE(table.is_used(before ? 3 : static_cast<std::int64_t>(plate.size()) - 3));
        EXPECT_EQ(table.at(100).phase, 0) << rest << ' ' << before;
        EXPECT_TRUE(table.is_used(100));
      }
}

TEST(LockCheck, UnreliablePlateIsReported) {
  std::vector<double> plate = plate_of({.frames = 200, .drop = {}}, 1);
  for (std::size_t f = 7; f < plate.size(); f += 20) plate[f] += 8;
  const PhaseTable table = check_lock({20, 0}, {.plate_px = plate, .times_s = {}});
  EXPECT_TRUE(table.out_of_lock.empty());
  EXPECT_NE(table.warning.find("off its sine in 10 of 200 frames"), std::string::npos) << table.warning;
}

TEST(LockCheck, OneFrameThatIsNotWhereItBelongsIsNamed) {
  std::vector<double> plate = plate_of({.frames = 100, .drop = {}}, 1);
  plate[33] = plate[40];
  EXPECT_NE(
      check_lock({20, 0}, {.plate_px = plate, .times_s = {}}).warning.find("off its sine in 1 of 100 frames"),
      std::string::npos);
}

/// Phases of a list: frame f is taken at `per_frame` f + `from` cycles.
PhaseTable listed(int frames, double per_frame, double from) {
  std::vector<double> cycles;
  for (int f = 0; f < frames; ++f) cycles.push_back(from + per_frame * f);
  PhaseTable table{.method = PhaseMethod::triggers};
  EXPECT_TRUE(set_phases_of_times(table, cycles, 0));
  return table;
}

TEST(LockCheck, ListIsCheckedAgainstThePlate) {
  const std::vector<double> plate = plate_of({.frames = 100, .drop = {}}, 1);
  PhaseTable right = listed(100, 0.05, 0);
  check_list_by_plate(right, plate, true);
  EXPECT_EQ(right.checked_by, "the plate");
  // A period of 19.3 frames, and one that is seen once per cycle only, stroboscopically.
  const std::vector<double> uneven = plate_of({.frames = 100, .period = 19.3, .drop = {}}, 2);
  PhaseTable free = listed(100, 1 / 19.3, 0), aliased = listed(100, 1 + 1 / 19.3, 0);
  check_list_by_plate(free, uneven, true);
  check_list_by_plate(aliased, uneven, true);
  // Triggers that miss a frame.
  Film gaps{.frames = 100, .drop = {30, 31, 60}};
  std::vector<double> cycles;
  for (const std::int64_t t : ticks_of(gaps)) cycles.push_back(0.05 * static_cast<double>(t));
  PhaseTable missing{.method = PhaseMethod::triggers};
  ASSERT_TRUE(set_phases_of_times(missing, cycles, 20));
  check_list_by_plate(missing, plate_of(gaps, 3), true);

  PhaseTable twice = listed(100, 0.1, 0), shifted = listed(100, 0.05, 0.25),
             milliseconds = listed(100, 50, 0);
  expect_refusal<ConfigError>([&] { check_list_by_plate(twice, plate, true); },
                              "by the list there are 10 frames per cycle", "repeats itself after 20 frames",
                              "--trust-stated-drive");
  expect_refusal<ConfigError>([&] { check_list_by_plate(shifted, plate, true); },
                              "0.25 of a cycle earlier in its cycle than the phases of the list state");
  expect_refusal<ConfigError>([&] { check_list_by_plate(milliseconds, plate, true); },
                              "repeats itself after 20 frames");
  // Triggers that are not in step with the frames: the phases of the list are the better ones.
  std::mt19937_64 random(6);
  std::vector<double> irregular, of_irregular;
  for (int f = 0; f < 160; ++f) {
    irregular.push_back(0.05 * f + std::normal_distribution<double>(0, 0.02)(random));
    of_irregular.push_back(40 + 12 * std::sin(kTurn * irregular.back()));
  }
  PhaseTable triggered{.method = PhaseMethod::triggers};
  ASSERT_TRUE(set_phases_of_times(triggered, irregular, 20));
  check_list_by_plate(triggered, of_irregular, true);
  EXPECT_EQ(triggered.checked_by, "the plate");
  // A list that spreads the missing frames over the film, as a sine of another period does.
  const Film lost{.frames = 160, .drop = {37, 38, 91, 120}};
  const std::vector<double> with_lost = plate_of(lost, 5);
  PhaseTable smooth = listed(static_cast<int>(with_lost.size()), 1 / 19.41, 0);
  expect_refusal<ConfigError>([&] { check_list_by_plate(smooth, with_lost, true); },
                              "frames from those of the plate in the frames (missing: 2 before frame 37",
                              "--trust-stated-drive");
  // The shaker starts after some cycles.
  for (const int resting : {60, 80, 100}) {
    std::vector<double> started(static_cast<std::size_t>(resting), plate[0]);
    started.insert(started.end(), plate.begin(), plate.begin() + 80);
    PhaseTable all = listed(resting + 80, 0.05, 0);
    check_list_by_plate(all, started, true);
  }
  PhaseTable recorded = listed(100, 0.05, 0.25);
  check_list_by_plate(recorded, plate, false);
  // Without a plate in the picture nothing is said.
  std::vector<double> noise(100);
  std::mt19937_64 generator(4);
  for (double& h : noise) h = std::normal_distribution<double>(0, 0.3)(generator);
  PhaseTable unseen = listed(100, 0.1, 0);
  check_list_by_plate(unseen, noise, true);
  EXPECT_EQ(unseen.checked_by, "");
}

TEST(LockCheck, TwoDriveStrengthsAreNotLostFrames) {
  std::vector<double> plate = plate_of({.frames = 60, .drop = {}}, 1);
  const std::vector<double> weaker = plate_of({.frames = 60, .amplitude = 7, .drop = {}}, 2);
  plate.insert(plate.end(), weaker.begin(), weaker.end());
  PhaseTable table = check_lock({20, 0}, {.plate_px = plate, .times_s = {}});
  EXPECT_EQ(table.dropped + table.doubled, 0);
  EXPECT_TRUE(table.frames.empty());
  EXPECT_NE(table.warning.find("px in the first 60 frames and by"), std::string::npos) << table.warning;
  EXPECT_TRUE(table.not_checked.empty()) << "the bed must not correct the phases";
}

TEST(LockCheck, TimeStampsShowGapsWhereThereIsNoPlate) {
  LockEvidence evidence;
  const Film film{.drop = {30, 31, 70}};
  for (const std::int64_t t : ticks_of(film)) evidence.times_s.push_back(0.002 * static_cast<double>(t));
  const PhaseTable table = check_lock({20, 0}, evidence);
  EXPECT_EQ(table.checked_by, "the time stamps");
  EXPECT_EQ(table.dropped, 3);
  EXPECT_EQ(right(table, film), 97U);
  evidence.times_s[50] += 0.001;
  EXPECT_EQ(check_lock({20, 0}, evidence).checked_by, "") << "half an interval is not a whole number";
}

TEST(LockCheck, TheBedShowsWhereFramesAreMissing) {
  for (const double gamma : {0.9, 1.6, 2.5})
    for (int at = 25; at < 65; at += 3) {
      const Film film{.frames = 120, .drop = {at}};
      PhaseTable table = check_lock({20, 0}, {});
      check_lock_by_bed(table, bed_of(film, gamma, 0, static_cast<unsigned>(at)));
      EXPECT_EQ(table.checked_by, "the bed") << table.not_checked;
      EXPECT_EQ(table.dropped, 1) << gamma << ' ' << at;
      EXPECT_GE(right(table, film), ticks_of(film).size() - 4) << gamma << ' ' << at;
    }
}

TEST(LockCheck, TheBedRaisesNoFalseAlarm) {
  int told = 0;
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const double spread : {0.0, 0.01, 0.05}) {
      PhaseTable table = check_lock({20, 0}, {});
      check_lock_by_bed(table, bed_of({.frames = 120, .drop = {}}, 1.6, spread, seed));
      EXPECT_TRUE(table.frames.empty()) << seed << ' ' << spread << ": " << table.warning;
      told += table.checked_by.empty() ? 0 : 1;
    }
  EXPECT_GE(told, 20) << "a bed that repeats itself exactly can always tell";
}

TEST(LockCheck, UncheckableCasesAreReported) {
  PhaseTable table = check_lock({20, 0}, {});
  check_lock_by_bed(table, {.heights = std::vector<double>(100, 3.0), .repeats = {}});
  EXPECT_EQ(table.checked_by, "");
  EXPECT_NE(table.not_checked.find("the bed is at rest"), std::string::npos) << table.not_checked;
  table = check_lock({20, 0}, {});
  check_lock_by_bed(table, {.heights = std::vector<double>(50, 3.0), .repeats = {}});
  EXPECT_NE(table.not_checked.find("less than three cycles"), std::string::npos) << table.not_checked;
}

}  // namespace twincell::lock_check_test
