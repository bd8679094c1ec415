// Drive amplitude from beds whose plate is not visible. The beds are simulated, of many kinds, and their
// beads are observed as a camera observes them.

#include "calibration/drive/bed_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::calibration::bed_drive_test {
namespace {

/// Camera view of a run: positions have an uncertainty of a fiftieth of a bead, and nothing below `lowest` is
/// visible.
MemoryTrajectory seen(const TrajectorySource& run, double lowest, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 0.02);
  TrajectoryInfo info = run.info();
  info.columns = {.identity = true, .phase = true};
  info.source = Origin::experiment;
  MemoryTrajectory out(info);
  Frame frame;
  for (std::size_t f = 0; f < run.n_frames(); ++f) {
    run.read(f, frame);
    frame.step = static_cast<std::int64_t>(f);
    frame.velocity.clear();
    frame.id.assign(frame.position.size(), 0);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      Vec3& r = frame.position[i];
      r += Vec3(noise(random), 0, noise(random));
      frame.id[i] = static_cast<std::int64_t>(i);
      if (r.z() < lowest) frame.id[i] = -1, r = Vec3::Constant(std::nan(""));
    }
    out.append(frame);
  }
  return out;
}

MemoryTrajectory simulated(const std::string& scene) {
  sim::Simulation run(sim::read_scene_text(scene, "bed"));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  return out;
}

BedDrive drive_seen(const MemoryTrajectory& run, double lowest, double stated_over_true, std::uint64_t seed) {
  MemoryTrajectory film = seen(run, lowest, seed);
  film.info().drive->amplitude *= stated_over_true;
  BedSteps steps(film.info());
  for (const Frame& frame : film.frames()) steps.append(frame);
  return drive_of_bed(steps, film.info());
}

std::string bed(double gamma, int seed, const std::string& kind, int layers) {
  return "preset = \"fortini-huang-2015\"\nbeads.layers = " + std::to_string(layers) +
         "\ncell.width = 10\n[drive]\ngamma = " + std::to_string(gamma) + "\n[start]\nkind = \"" + kind +
         "\"\nseed = " + std::to_string(seed) +
         "\n[time]\nphases = 20\ncycles = 8\ndiscard = 2\nsteps_per_contact = 12\nintegrator = \"split\"\n";
}

/// Largest relative difference from the true amplitude, over beds of two heights, several seeds and three
/// statements of the drive. It is 2 if the bed does not determine the amplitude.
double worst(double gamma) {
  double largest = 0;
  for (const int layers : {4, 10})
    for (const int seed : {1, 2, 3}) {
      const MemoryTrajectory run = simulated(bed(gamma, seed, "random", layers));
      for (const double stated : {1.0, 1.6, 1 / 1.6}) {
        const BedDrive d = drive_seen(run, 1.5, stated, static_cast<std::uint64_t>(seed));
        largest = std::max(
            largest, d.not_comparable.empty() ? std::abs(d.amplitude / run.info().drive->amplitude - 1) : 2);
      }
    }
  return largest;
}

TEST(BedDrive, IsShownByBedsThatLieOnThePlateForAThirdOfTheCycle) {
  for (const double gamma : {0.5, 0.9, 1.2, 1.6})
    test::validate({"V6.3",
                    "largest error of A by the bed alone over 18 films, shares of A, Gamma " +
                        std::to_string(gamma).substr(0, 3),
                    0, 0.05, "the run's own drive"},
                   worst(gamma));
}

// A first phase that is stated wrongly shifts all phases. The bed shows by how much.
TEST(BedDrive, ShowsAWrongFirstPhase) {
  for (const double gamma : {0.9, 1.2, 1.4})
    for (const int layers : {4, 10}) {
      const MemoryTrajectory run = simulated(bed(gamma, 1, "random", layers));
      for (const int late : {0, 1, 2, 7, 10, 19}) {
        MemoryTrajectory film = seen(run, 1.5, 1);
        const int n = film.info().phases_per_cycle;
        BedSteps steps(film.info());
        for (Frame frame : film.frames()) {
          const std::int64_t at = frame.cycle * n + frame.phase + late;
          frame.phase = static_cast<std::int32_t>(at % n);
          frame.cycle = at / n;
          frame.time += late * film.info().drive->period() / n;
          steps.append(frame);
        }
        const BedDrive d = drive_of_bed(steps, film.info());
        ASSERT_TRUE(d.not_comparable.empty()) << gamma << ' ' << late << ": " << d.not_comparable;
        EXPECT_EQ((d.phase_shift + late) % n, 0) << gamma << ", " << layers << " layers, " << late;
        EXPECT_NEAR(d.amplitude / film.info().drive->amplitude, 1, 0.05);
      }
    }
}

TEST(BedDrive, IsNotShownByBedsThatFlyTooLongOrAreNone) {
  const auto silent = [](const MemoryTrajectory& run, const char* what) {
    for (const double stated : {1.0, 1.6, 1 / 1.6}) {
      const BedDrive d = drive_seen(run, 0.2, stated, 1);
      EXPECT_FALSE(d.not_comparable.empty())
          << what << " gave A = " << d.amplitude << ", true " << run.info().drive->amplitude;
    }
  };
  for (const double gamma : {2.5, 3.0, 4.5, 6.0})
    for (const int seed : {1, 2, 3, 4}) silent(simulated(bed(gamma, seed, "random", 8)), "a bed that flies");
  silent(simulated("preset = \"bhateja-2016-smooth-2d\"\n[drive]\nk_m = 20\n[time]\ndiscard = 5\ncycles = "
                   "20\nphases = 20\n"),
         "a gas");
  const auto few =
      drive_seen(test::rigid_bed({.gamma = 0.9, .columns = 4, .rows = 5, .cycles = 6}), 0.2, 1, 1);
  EXPECT_NE(few.not_comparable.find("columns of beads"), std::string::npos) << few.not_comparable;
  const auto brief = drive_seen(test::rigid_bed({.gamma = 0.9, .rows = 5, .cycles = 2}), 0.2, 1, 1);
  EXPECT_FALSE(brief.not_comparable.empty());
  TrajectoryInfo shaken = test::rigid_bed({.gamma = 0.9, .rows = 5, .cycles = 6}).info();
  shaken.drive->harmonics = {{0.1, 0}};
  EXPECT_EQ(drive_of_bed(BedSteps(shaken), shaken).not_comparable, "the drive is not a sine");
}

// The accelerations of beds of all strengths and heights contradict no drive; those of upside-down pictures
// do where the bed lands on its plate.
TEST(BedDrive, UpsideDownPicturesAndBedsAtRestContradictTheDrive) {
  int found = 0, flying = 0;
  for (const double gamma : {0.9, 1.6, 2.0, 3.0})
    for (const int layers : {4, 20}) {
      const MemoryTrajectory run = simulated(bed(gamma, 1, "random", layers));
      EXPECT_EQ(drive_seen(run, 0.2, 1, 1).contradiction, "") << gamma << ", " << layers << " layers";
      MemoryTrajectory flipped(run.info());
      for (Frame frame : run.frames()) {
        for (Vec3& r : frame.position) r.z() = 30 - r.z();
        flipped.append(frame);
      }
      const BedDrive d = drive_seen(flipped, 0.2, 1, 1);
      // A bed that hardly flies shows another first phase instead; one that flies for longer than a cycle
      // lands at other phases each time.
      if (gamma < 1.5 || gamma > 2) continue;
      ++flying;
      found += d.contradiction.find("upside down") != std::string::npos ? 1 : 0;
    }
  std::cout << found << " of " << flying << " beds in upside-down pictures\n";
  EXPECT_GE(found, flying - 1);
  MemoryTrajectory still(simulated(bed(1.6, 1, "random", 4)).info());
  const MemoryTrajectory moving = simulated(bed(1.6, 1, "random", 4));
  for (Frame frame : moving.frames()) {
    frame.position = moving.frames().front().position;
    still.append(frame);
  }
  EXPECT_NE(drive_seen(still, 0.2, 1, 1).contradiction.find("the beads stand still in the frames"),
            std::string::npos);
}

// The plate in the picture shows amplitude and phases, not the frequency. The bed does: it falls by 1 g.
TEST(BedDrive, AWrongFrequencyContradictsTheFallOfTheBed) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const double gamma : {0.8, 0.9, 1.2, 1.6, 2.0, 3.0})
    for (const int layers : {4, 10, 20}) {
      const MemoryTrajectory film = seen(simulated(bed(gamma, 2, "random", layers)), 0.2, 1);
      const auto said = [&](double frequency) {
        TrajectoryInfo info = film.info();
        info.drive->omega *= frequency;
        BedSteps steps(info);
        for (Frame frame : film.frames()) {
          frame.time /= frequency;
          steps.append(frame);
        }
        return contradiction_of_bed(steps, info);
      };
      EXPECT_EQ(said(1), "") << gamma << ", " << layers << " layers";
      EXPECT_EQ(said(1.05), "") << gamma << ", " << layers << " layers";
      // The columns of a thin bed that is thrown high do not move together, as in a gas.
      const bool as_one = gamma < 2 || layers >= (gamma < 3 ? 10 : 20);
      EXPECT_EQ(said(kTurn).empty(), !as_one) << gamma << ", " << layers << " layers: rad/s stated as Hz";
      // A bed that hardly leaves its plate fits a plate of any weakness.
      if (gamma < 1.3) continue;
      EXPECT_NE(said(1 / kTurn), "") << gamma << ", " << layers << " layers: Hz stated as rad/s";
    }
}

/// What contradicts a drive of `frequency` times the true one in the frames from `first` to `last`, of which
/// every `every`-th is kept.
std::string contradiction_seen(const MemoryTrajectory& film, double frequency, std::size_t first,
                               std::size_t last, int every) {
  TrajectoryInfo info = film.info();
  info.drive->omega *= frequency;
  info.phases_per_cycle /= every;
  BedSteps steps(info);
  for (std::size_t f = first; f < std::min(last, film.n_frames()); f += static_cast<std::size_t>(every)) {
    Frame frame = film.frames()[f];
    frame.time /= frequency;
    frame.phase /= every;
    frame.step /= every;
    steps.append(frame);
  }
  return contradiction_of_bed(steps, info);
}

// A bed that follows its plate over the whole cycle is accelerated downwards by the plate's acceleration.
TEST(BedDrive, ABedThatIsNotThrownContradictsAStrongPlate) {
  for (const double gamma : {0.5, 0.9})
    for (const int layers : {4, 10, 20}) {
      const MemoryTrajectory film = seen(simulated(bed(gamma, 1, "random", layers)), 0.2, 1);
      const std::string what =
          std::to_string(gamma) + ", " + std::to_string(layers) + " layers, frequency x ";
      const auto frames = static_cast<std::size_t>(film.info().phases_per_cycle);
      for (const double stated : {1.5, 2.0, 3.6, 35.0}) {
        const double frequency = std::sqrt(stated / gamma);
        for (const std::size_t cycles : {2U, 8U})
          EXPECT_NE(
              contradiction_seen(film, frequency, 0, cycles * frames, 1).find("the bed follows its plate"),
              std::string::npos)
              << what << frequency << ", " << cycles << " cycles";
        EXPECT_NE(contradiction_seen(film, frequency, 0, 8 * frames, 2).find("the bed follows its plate"),
                  std::string::npos)
            << what << frequency << ", every second frame";
      }
    }
}

// Short flights of a fraction of a bead, two cycles and coarse frames are no contradiction.
TEST(BedDrive, TheRightFrequencyIsContradictedByNoBed) {
  std::string finer = "phases = 40";
  for (const double gamma : {0.5, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.6, 2.0, 3.0})
    for (const int layers : {4, 10, 20}) {
      std::string scene = bed(gamma, 3, "random", layers);
      scene.replace(scene.find("phases = 20"), finer.size(), finer);
      const MemoryTrajectory film = seen(simulated(scene), 0.2, 1);
      for (const int every : {1, 2, 4, 5})
        for (const std::size_t first : {0U, 80U, 160U})
          for (const std::size_t length : {80U, 120U, 320U})
            for (const double frequency : {1.0, 1.03})
              EXPECT_EQ(contradiction_seen(film, frequency, first, first + length, every), "")
                  << gamma << ", " << layers << " layers, every " << every << ". frame from " << first << ", "
                  << length << " frames, frequency x " << frequency;
    }
}

TEST(BedDrive, RigidBedIsExactWithinItsStatedError) {
  // The bed has a closed form and noise of 0.02 sigma. The errors must be small, and the differences must
  // agree with them.
  double squares = 0, n = 0;
  for (const double gamma : {0.7, 1.3, 1.6})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const MemoryTrajectory run = test::rigid_bed({.gamma = gamma, .rows = 5, .phases = 20, .cycles = 10});
      const BedDrive d = drive_seen(run, 0.2, 1.6, seed);
      ASSERT_TRUE(d.not_comparable.empty()) << gamma << ": " << d.not_comparable;
      EXPECT_LT(d.amplitude_error, 0.02 * gamma);
      squares += std::pow((d.amplitude - gamma) / d.amplitude_error, 2);
      ++n;
    }
  // Mean square of Student's t with 8 degrees of freedom: 8/6.
  test::validate({"V6.3", "mean square of (A - truth)/error, rigid beds", 8.0 / 6, 0.6, "Student's t"},
                 squares / n);
}

TEST(BedDrive, TimeOnThePlateIsThatOfABodyThatDoesNotRebound) {
  EXPECT_EQ(time_on_plate(0.99)->to, 1);
  const auto on = time_on_plate(1.6);
  ASSERT_TRUE(on);
  EXPECT_NEAR(on->to, std::asin(1 / 1.6) / (2 * std::numbers::pi), 1e-12);
  EXPECT_EQ(reproduce::rigid_bed_height(1.6, 2 * std::numbers::pi * (on->from + 1.001)), 0);
  EXPECT_GT(reproduce::rigid_bed_height(1.6, 2 * std::numbers::pi * (on->from + 0.999)), 0);
  EXPECT_FALSE(time_on_plate(3.4));
}

}  // namespace
}  // namespace twincell::calibration::bed_drive_test
