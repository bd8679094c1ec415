#include "trajectory/drive_ramp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::drive_ramp_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A ramp of every kind, with and without a way back.
std::vector<DriveRamp> ramps() {
  std::vector<DriveRamp> all;
  for (const int power : {0, 1, 2})
    for (const bool returns : {false, true})
      for (const DriveLevel to : {DriveLevel{1.9, 1.25}, DriveLevel{0.3, 1.25}, DriveLevel{1.1, 3.5},
                                  DriveLevel{0, 0.5}, DriveLevel{2.2, 0.7}})
        all.push_back(
            {.from = {0.8, 1.25}, .to = to, .power = power, .first = 3, .cycles = 8, .returns = returns});
  return all;
}

Drive drive_of(const DriveRamp& ramp, std::vector<Harmonic> harmonics = {}) {
  Drive drive{.amplitude = ramp.from.amplitude, .omega = ramp.from.omega};
  drive.harmonics = std::move(harmonics);
  drive.ramp = ramp;
  return drive;
}

/// The motion at `cycles` cycles after its start.
struct Motion {
  double z, v, a;
};
Motion at(const Drive& d, double cycles) {
  const double whole = std::floor(cycles);
  const auto cycle = static_cast<std::int64_t>(whole);
  return {d.displacement(cycles - whole, cycle), d.velocity(cycles - whole, cycle),
          d.acceleration(cycles - whole, cycle)};
}

// A chirp: the phase of a frequency that rises linearly in the time T is omega_0 t + (omega_1 - omega_0)
// t^2/2T, and n cycles take T = 4 pi n/(omega_0 + omega_1).
TEST(DriveRamp, AFrequencyRampIsALinearChirp) {
  const DriveRamp ramp{.from = {0.8, 1.25}, .to = {0.8, 3.5}, .power = 0, .first = 0, .cycles = 20};
  const Drive drive = drive_of(ramp);
  const double duration = 2 * kTurn * 20 / (1.25 + 3.5);
  EXPECT_NEAR(drive.time_at(20), duration, 1e-12 * duration);
  for (double t = 0.01; t < duration; t += 0.37) {
    const double angle = 1.25 * t + (3.5 - 1.25) * t * t / (2 * duration),
                 rate = 1.25 + (3.5 - 1.25) * t / duration;
    EXPECT_NEAR(drive.cycles_at(t), angle / kTurn, 1e-12);
    const Motion m = at(drive, drive.cycles_at(t));
    EXPECT_NEAR(m.z, 0.8 * std::sin(angle), 1e-11);
    EXPECT_NEAR(m.v, 0.8 * rate * std::cos(angle), 1e-10);
    EXPECT_NEAR(m.a, 0.8 * ((3.5 - 1.25) / duration * std::cos(angle) - rate * rate * std::sin(angle)),
                1e-10);
  }
  EXPECT_NEAR(drive.time_at(25) - drive.time_at(24), kTurn / 3.5, 1e-12);
}

TEST(DriveRamp, TimeAndCyclesAreInverse) {
  for (const DriveRamp& ramp : ramps())
    for (double c = -1.5; c < 14; c += 0.13) {
      const double t = ramp.time_at(c);
      EXPECT_NEAR(ramp.cycles_at(t), c, 1e-12);
      EXPECT_NEAR((ramp.time_at(c + 1e-5) - ramp.time_at(c - 1e-5)) / 2e-5, kTurn / ramp.level(c).omega,
                  1e-4);  // it has a kink where the ramp turns
    }
}

// The quantity of the ramp is linear in time, the others are not.
TEST(DriveRamp, TheStatedQuantityIsLinearInTime) {
  for (const DriveRamp& ramp : ramps()) {
    const auto quantity = [&](const DriveLevel& l) { return l.amplitude * std::pow(l.omega, ramp.power); };
    const double way = ramp.returns ? 4 : 8, begin = ramp.time_at(3), end = ramp.time_at(3 + way);
    for (double c = 3; c <= 3 + way; c += 0.25) {
      const double share = (ramp.time_at(c) - begin) / (end - begin);
      EXPECT_NEAR(quantity(ramp.level(c)),
                  quantity(ramp.from) + share * (quantity(ramp.to) - quantity(ramp.from)), 1e-12);
      EXPECT_NEAR(ramp.level(c).omega, ramp.from.omega + share * (ramp.to.omega - ramp.from.omega), 1e-12);
    }
    if (ramp.returns) {
      for (double c = 0; c < 4; c += 0.3)
        EXPECT_NEAR(ramp.level(7 - c).amplitude, ramp.level(7 + c).amplitude, 1e-12);
    }
    EXPECT_EQ(ramp.level(100), ramp.returns ? ramp.from : ramp.to);
    EXPECT_EQ(ramp.level(0), ramp.from);
  }
}

// Velocity and acceleration are the derivatives of the displacement in time, and displacement and velocity
// are continuous where the ramp begins, turns and ends.
TEST(DriveRamp, TheMotionIsSmooth) {
  for (const DriveRamp& ramp : ramps())
    for (const auto& harmonics : {std::vector<Harmonic>{}, std::vector<Harmonic>{{0.2, 0.25}, {0.05, 0.1}}}) {
      const Drive drive = drive_of(ramp, harmonics);
      constexpr double h = 1e-4;
      const auto moment = [&](double t) { return at(drive, drive.cycles_at(t)); };
      for (double c = 0.013; c < 13; c += 0.11) {
        const double t = drive.time_at(c);
        const Motion before = moment(t - h), now = moment(t), after = moment(t + h);
        EXPECT_NEAR((after.z - before.z) / (2 * h), now.v, 1e-5) << c;
        EXPECT_NEAR((after.v - before.v) / (2 * h), now.a, 3e-5) << c;
      }
      for (const double corner : {3.0, 7.0, 11.0}) {
        const Motion before = at(drive, corner - 1e-9), after = at(drive, corner + 1e-9);
        EXPECT_NEAR(before.z, after.z, 1e-6);
        EXPECT_NEAR(before.v, after.v, 1e-6);
      }
    }
}

TEST(DriveRamp, BoundsHoldAndAreReached) {
  for (const DriveRamp& ramp : ramps()) {
    const Drive drive = drive_of(ramp);
    double farthest = 0, fastest = 0, rate = 0;
    std::vector<double> most(3, 0);
    for (double c = 0; c < 13; c += 1e-3) {
      const Motion m = at(drive, c);
      farthest = std::max(farthest, std::abs(m.z));
      fastest = std::max(fastest, std::abs(m.v));
      rate = std::max(rate, std::abs(ramp.state(c).rate));
      const DriveLevel l = ramp.level(c);
      for (int k = 0; k < 3; ++k)
        most[static_cast<std::size_t>(k)] =
            std::max(most[static_cast<std::size_t>(k)], l.amplitude * std::pow(l.omega, k));
    }
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(ramp.largest(k), most[static_cast<std::size_t>(k)], 1e-3 * ramp.largest(k));
    EXPECT_LE(rate, ramp.rate_bound() * (1 + 1e-12));
    EXPECT_LE(farthest, drive.displacement_bound() * (1 + 1e-12));
    EXPECT_GE(farthest, 0.8 * drive.displacement_bound());
    EXPECT_LE(fastest, drive.velocity_bound());
    EXPECT_GE(fastest, 0.7 * drive.velocity_bound());
  }
}

TEST(DriveRamp, TheDriveOfACycleIsItsNumbersThere) {
  const Drive drive = drive_of({.from = {1.2, 1}, .to = {2.4, 1}, .power = 2, .first = 10, .cycles = 100});
  EXPECT_NEAR(drive.at(60).gamma(), 1.8, 1e-12);
  EXPECT_NEAR(drive.at(60).k_m(), 1.8 * 1.8, 1e-12);
  EXPECT_EQ(drive.at(60).ramp, std::nullopt);
  EXPECT_EQ(drive.at(0).gamma(), 1.2);
  EXPECT_EQ(drive.cycle_at(drive.time_at(37.25), 0.25), 37);
}

TEST(HorizontalMotion, IsAlongXBesideTheVerticalOne) {
  Drive drive{.amplitude = 0.3, .omega = 2};
  drive.horizontal = HorizontalMotion{.amplitude = 0.4, .ratio = 3, .phase = 0.1};
  for (double f = 0; f < 1; f += 0.07) {
    const double angle = 3 * kTurn * f + 0.1 * kTurn;
    const Vec3 r = drive.displacement_in_space(f), v = drive.velocity_in_space(f);
    EXPECT_NEAR(r.x(), 0.4 * std::sin(angle), 1e-14);
    EXPECT_NEAR(v.x(), 0.4 * 6 * std::cos(angle), 1e-13);
    EXPECT_EQ(r.z(), drive.displacement(f));
    EXPECT_EQ(v.z(), drive.velocity(f));
    EXPECT_EQ(r.y(), 0);
    EXPECT_LE(r.norm(), drive.displacement_bound());
    EXPECT_LE(v.norm(), drive.velocity_bound());
  }
  EXPECT_NEAR(drive.displacement_bound(), 0.5, 1e-15);
}

/// A file with one bead at rest and this drive.
void write(const std::filesystem::path& file, const Drive& drive) {
  TrajectoryInfo info;
  info.n_beads = 1;
  info.drive = drive;
  H5mdWriter writer(file, info);
  Frame frame;
  frame.position = {Vec3(0, 0, 0)};
  writer.append(frame);
  writer.finish();
}

TEST(DriveMotionGroup, NumbersThatNoDriveHasAreRefused) {
  const TemporaryFolder folder;
  const DriveRamp good{.from = {0.8, 1.25}, .to = {1.1, 3.5}, .power = 2, .first = 3, .cycles = 8};
  const auto said = [&](const Drive& drive) {
    write(folder / "t.h5", drive);
    const std::string complaint = complaint_of([&] { H5mdReader(folder / "t.h5"); });
    std::filesystem::remove(folder / "t.h5");
    return complaint;
  };
  EXPECT_EQ(said(drive_of(good)), "");
  const auto ramp = [&](auto change) {
    DriveRamp bad = good;
    change(bad);
    return said(drive_of(bad));
  };
  const std::string where = "t.h5: parameters/drive/ramp: its ";
  EXPECT_NE(ramp([](DriveRamp& r) { r.to.omega = 0; }).find(where + "omega is 0"), std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.to.amplitude = -1; }).find(where + "amplitude is -1"),
            std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.to.amplitude = std::nan(""); }).find(where + "amplitude is nan"),
            std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.power = 3; }).find(where + "power is 3"), std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.cycles = 0.5; }).find(where + "cycles is 0.5"), std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.first = -1; }).find(where + "first is -1"), std::string::npos);
  EXPECT_NE(ramp([](DriveRamp& r) { r.from.omega = 0; }).find("has a ramp, but its omega is 0"),
            std::string::npos);
  Drive sideways{.amplitude = 1, .omega = 1};
  for (const HorizontalMotion bad : {HorizontalMotion{-1, 1, 0}, HorizontalMotion{1, 0, 0},
                                     HorizontalMotion{1, 32, 0}, HorizontalMotion{1, 1, 1.5}}) {
    sideways.horizontal = bad;
    EXPECT_NE(said(sideways).find("t.h5: parameters/drive/horizontal: its "), std::string::npos);
  }
}

TEST(DriveMotionGroup, RampAndHorizontalMotionSurviveAFile) {
  const TemporaryFolder folder;
  Drive drive =
      drive_of({.from = {0.8, 1.25}, .to = {1.1, 3.5}, .power = 2, .first = 3, .cycles = 8, .returns = true});
  drive.horizontal = HorizontalMotion{.amplitude = 0.4, .ratio = 3, .phase = 0.1};
  write(folder / "t.h5", drive);
  const Drive read = *H5mdReader(folder / "t.h5").info().drive;
  ASSERT_TRUE(read.ramp && read.horizontal);
  EXPECT_EQ(read.ramp->from, drive.ramp->from);
  EXPECT_EQ(read.ramp->to, drive.ramp->to);
  EXPECT_EQ(read.ramp->power, 2);
  EXPECT_EQ(read.ramp->first, 3);
  EXPECT_EQ(read.ramp->cycles, 8);
  EXPECT_TRUE(read.ramp->returns);
  EXPECT_EQ(read.horizontal->amplitude, 0.4);
  EXPECT_EQ(read.horizontal->ratio, 3);
  EXPECT_EQ(read.horizontal->phase, 0.1);
  EXPECT_EQ(read.formula(), drive.formula());
}

}  // namespace
}  // namespace twincell::drive_ramp_test
