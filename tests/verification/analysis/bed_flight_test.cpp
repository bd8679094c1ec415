// Flight times of beds whose motion is known in closed form (docs/validation.md: V5.17).
#include "analysis/motion/bed_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "sim/scene/read_scene.hpp"
#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::bed_flight_test {

using namespace analysis;

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Flight time of a bed that takes off at sin(phi) = 1/Gamma and lands on the plate, omega = g = 1.
double flight_of_rigid_bed(double gamma) {
  const double start = std::asin(1 / gamma);
  const auto gap = [&](double t) {
    return 1 + gamma * std::cos(start) * t - t * t / 2 - gamma * std::sin(start + t);
  };
  double low = 0.5, high = low;
  while (gap(high) > 0) high += 0.01;
  low = high - 0.01;
  for (int i = 0; i < 60; ++i) (gap((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
  return low;
}

double measured(const MemoryTrajectory& film, const std::string& name = "flight_time") {
  return find_result(analyze(film, {.only = {"flight_time", "flight_share"}}), name).value();
}

MemoryTrajectory with_noise(const MemoryTrajectory& clean, double noise, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, noise);
  MemoryTrajectory noisy(clean.info());
  for (Frame frame : clean.frames()) {
    for (Vec3& r : frame.position) r.z() += normal(generator);
    noisy.append(frame);
  }
  return noisy;
}

std::string text(double v) {
  char out[32];
  std::snprintf(out, sizeof out, "%g", v);
  return out;
}

}  // namespace

// Another gravity is another unit of time: with g -> k^2 g and omega -> k omega the motion is the same, k
// times faster.
TEST(BedFlight, FollowsTheGravityOfTheRun) {
  const auto film = test::rigid_bed({.gamma = 1.7, .columns = 8, .rows = 3, .phases = 20, .cycles = 8});
  for (const double faster : {0.3, 2.0}) {
    TrajectoryInfo info = film.info();
    info.drive->gravity = faster * faster;
    info.drive->omega *= faster;
    MemoryTrajectory scaled(info);
    for (Frame frame : film.frames()) {
      frame.time /= faster;
      scaled.append(frame);
    }
    EXPECT_NEAR(measured(scaled) * faster / measured(film), 1, 1e-8) << faster;
    EXPECT_NEAR(measured(scaled, "flight_share"), measured(film, "flight_share"), 1e-8) << faster;
  }
}

// Along z a bed in a tilted cell flies as one under g cos(theta): with |g| larger by 1/cos(theta) its film is
// the same.
TEST(BedFlight, FollowsTheComponentOfGravityThatPointsAtThePlate) {
  const auto film = test::rigid_bed({.gamma = 1.7, .columns = 8, .rows = 3, .phases = 20, .cycles = 8});
  // |g| of a cell whose g_z is -1, and what its scene states.
  const std::pair<double, std::string> cells[] = {
      {1 / std::cos(20 * kTurn / 360), "tilt = 20.0\ngravity = 1.06417777247591"},
      {1 / std::cos(42 * kTurn / 360), "tilt = -42\ngravity = 1.345632729606"},
      {1.25, "gravity = [0.75, -1.0]"},
      {1.25, "dimension = 3\ndepth = 4.0\ngravity = [0.0, -0.75, -1]"},
      {1, "gravity = 1.0"}};
  for (const auto& [g, cell] : cells) {
    const sim::Scene scene = sim::read_scene_text(
        "[beads]\ncount = 4\n[drive]\ngamma = 1.7\nomega = 1.0\n[cell]\nwidth = 8.0\n" + cell + "\n",
        "scene");
    EXPECT_NEAR(scene.drive.gravity * scene.drive.downward_share, 1, 1e-9) << cell;
    MemoryTrajectory tilted = film;
    tilted.info().drive->gravity = g;
    tilted.info().drive->downward_share = scene.drive.downward_share;
    test::validate({"V5.17", "flight of the rigid bed at Gamma = 1.7, |g| = " + text(g) + " g_z, t0",
                    flight_of_rigid_bed(1.7), 1e-6 * flight_of_rigid_bed(1.7), "closed form"},
                   measured(tilted));
    EXPECT_NEAR(measured(tilted, "flight_share"), measured(film, "flight_share"), 1e-9) << cell;
  }
  MemoryTrajectory hanging = film;
  hanging.info().drive->downward_share = -1;
  EXPECT_NE(find_result(analyze(hanging, {.only = {"flight_time"}}), "flight_time")
                .absent.find("does not pull the bed onto the plate"),
            std::string::npos);
}

// Walls along z move, the plate does not: its stored height is 0, and the drive throws nothing.
TEST(BedFlight, RestingPlateGivesNoResult) {
  const auto film = test::rigid_bed({.gamma = 1.7, .columns = 8, .rows = 3, .phases = 20, .cycles = 8});
  MemoryTrajectory rests(film.info());
  for (Frame frame : film.frames()) {
    frame.plate_height = 0;
    rests.append(frame);
  }
  EXPECT_EQ(find_result(analyze(rests, {.only = {"flight_time"}}), "flight_time").absent, "the plate rests");
}

TEST(BedFlight, RigidBedAgreesWithItsParabola) {
  for (const double gamma : {1.15, 1.3, 1.7, 2.2, 3.0})
    for (const int phases : {20, 60}) {
      const auto film =
          test::rigid_bed({.gamma = gamma, .columns = 8, .rows = 3, .phases = phases, .cycles = 8});
      const double exact = flight_of_rigid_bed(gamma);
      test::validate(
          {"V5.17", "flight of the rigid bed, Gamma = " + text(gamma) + ", " + text(phases) + " phases, t0",
           exact, 1e-6 * exact, "closed form"},
          measured(film));
      EXPECT_NEAR(measured(film, "flight_share"), measured(film) / kTurn, 1e-9);
    }
}

TEST(BedFlight, PixelNoiseDoesNotChangeIt) {
  // 195 beads measured to 0.03 sigma each give the centre of mass to 0.002 sigma.
  const auto clean = test::rigid_bed({.gamma = 2.0, .cycles = 60});
  const Result flight =
      find_result(analyze(with_noise(clean, 0.03, 3), {.only = {"flight_time"}}), "flight_time");
  test::validate({"V5.17", "flight of the rigid bed at Gamma = 2, beads known to 0.03 sigma, t0",
                  flight_of_rigid_bed(2), 0.01 * flight_of_rigid_bed(2), "closed form"},
                 flight.value());
  ASSERT_TRUE(flight.interval);
  EXPECT_LT(flight.interval->high - flight.interval->low, 0.1);
}

// The second difference of 60 beads is uncertain by 0.1 g.
TEST(BedFlight, FewNoisyBeadsKeepTheirFlights) {
  for (const int phases : {20, 40})
    for (const double gamma : {1.5, 2.0}) {
      const auto clean =
          test::rigid_bed({.gamma = gamma, .columns = 12, .rows = 5, .phases = phases, .cycles = 40});
      const Result flight =
          find_result(analyze(with_noise(clean, 0.03, 1), {.only = {"flight_time"}}), "flight_time");
      const double exact = flight_of_rigid_bed(gamma);
      test::validate({"V5.17",
                      "flight of 60 beads known to 0.03 sigma, Gamma = " + text(gamma) + ", " + text(phases) +
                          " frames per cycle, t0",
                      exact, 0.015 * exact, "closed form"},
                     flight.value());
    }
}

TEST(BedFlight, ABedThatStaysOnItsPlateHasNone) {
  for (const double gamma : {0.5, 0.9, 0.99}) {
    const auto results = analyze(test::rigid_bed({.gamma = gamma, .columns = 8, .rows = 3}),
                                 {.only = {"flight_time", "flight_share"}});
    EXPECT_EQ(find_result(results, "flight_share").value(), 0) << gamma;
    EXPECT_NE(find_result(results, "flight_time").absent.find("did not leave"), std::string::npos);
  }
}

TEST(BedFlight, AFilmWithGapsLosesFlightsAndNothingElse) {
  const auto whole = test::rigid_bed({.gamma = 2.0, .columns = 8, .rows = 3, .cycles = 40});
  MemoryTrajectory holed(whole.info());
  for (std::size_t f = 0; f < whole.n_frames(); ++f)
    if (f % 97 != 50) holed.append(whole.frames()[f]);
  const auto results = analyze(holed, {.only = {"flight_time", "flight_share"}});
  const Result& flight = find_result(results, "flight_time");
  EXPECT_NEAR(flight.value(), measured(whole), 1e-6);
  EXPECT_LT(flight.n, 39U);
  EXPECT_GT(flight.n, 20U);
}

TEST(BedFlight, BeadsThatComeAndGoDoNotBreakFlights) {
  // Every frame lacks one bead in ten, different ones each time: the mean height of the detected beads jumps
  // by 0.1 sigma.
  const auto whole = test::rigid_bed({.gamma = 2.0, .columns = 10, .rows = 8, .cycles = 20});
  MemoryTrajectory seen(whole.info());
  seen.info().columns.identity = true;
  for (Frame frame : whole.frames()) {
    frame.id.resize(frame.position.size());
    for (std::size_t i = 0; i < frame.id.size(); ++i) {
      const bool missed = (i / 8 + static_cast<std::size_t>(frame.step) * 7) % 10 == 0;
      frame.id[i] = missed ? -1 : static_cast<std::int64_t>(i);
      if (missed) frame.position[i] = Vec3::Constant(std::nan(""));
    }
    seen.append(frame);
  }
  EXPECT_NEAR(measured(seen), measured(whole), 1e-6);
  EXPECT_NEAR(measured(seen, "flight_share"), measured(whole, "flight_share"), 1e-6);
}

TEST(BedFlight, UndecidableCasesGiveNoResult) {
  const auto absent = [](MemoryTrajectory film) {
    const auto results = analyze(film, {.only = {"flight_time", "flight_share"}});
    return find_result(results, "flight_share").absent;
  };
  EXPECT_NE(absent(test::rigid_bed({.phases = 6})).find("8 frames"), std::string::npos);
  EXPECT_NE(absent(test::rigid_bed({.phases = 20, .cycles = 1})).find("no whole cycle"), std::string::npos);
  auto undriven = test::rigid_bed({});
  undriven.info().drive.reset();
  EXPECT_NE(absent(undriven).find("drive"), std::string::npos);
  auto sideways = test::rigid_bed({});
  sideways.info().drive->axis = Axis::x;
  EXPECT_NE(absent(sideways).find("along z"), std::string::npos);
}

// A bead of restitution e on its period-1 orbit (Mehta & Luck 1990 and earlier) is always in flight, one
// period per flight.
TEST(BedFlight, ReboundingBead) {
  const double e = 0.5, gamma = 1.3, speed = std::numbers::pi;
  const double phase = std::acos(std::numbers::pi * (1 - e) / ((1 + e) * gamma));
  MemoryTrajectory film(test::rigid_bed_info({.gamma = gamma, .columns = 1, .rows = 1}));
  for (int f = 0; f < 20 * 12; ++f) {
    Frame frame;
    frame.step = f;
    frame.phase = f % 20;
    frame.cycle = f / 20;
    frame.time = kTurn * f / 20;
    frame.plate_height = film.info().drive->displacement(frame.phase / 20.0);
    double since = std::fmod(frame.time - phase + kTurn, kTurn);
    frame.position = {Vec3(0.5, 0, 0.5 + gamma * std::sin(phase) + speed * since - since * since / 2)};
    frame.velocity = {Vec3(0, 0, speed - since)};
    film.append(frame);
  }
  test::validate(
      {"V5.17", "share of the time in flight of a bead on its orbit of period 1", 1, 0.05, "closed form"},
      measured(film, "flight_share"));
  test::validate(
      {"V5.17", "flight of a bead on its orbit of period 1, t0", kTurn, 0.05 * kTurn, "closed form"},
      measured(film));
}

}  // namespace twincell::bed_flight_test
