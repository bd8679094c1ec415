// Runs on a plate whose motion was recorded (docs/validation.md: V4.16).

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/validation.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell::sim::recorded_drive_test {
namespace {

using test::validate;
using test::validate_bound;
constexpr double kTurn = 2 * std::numbers::pi;

// z = 2t - t^3/12: the plate's acceleration -t/2 passes that of gravity at t = 2, where z = 10/3 and z' = 1.
// An inelastic bead leaves it there and rises by 1/2.
TEST(RecordedDrive, TheBeadTakesOffWhereThePlateFallsFasterThanGravity) {
  std::vector<MotionSample> samples;
  for (int k = 0; k <= 40; ++k) {
    const double t = 0.25 * k;
    samples.push_back({2 * t - t * t * t / 12, 2 - t * t / 4, -t / 2});
  }
  for (const auto& [kind, name] : {std::pair{SolverKind::best, "vector kernels"},
                                   {SolverKind::scalar, "scalar kernels"},
                                   {SolverKind::all_pairs, "all pairs"}}) {
    Bench b("[contact]\ntangential = \"none\"\ngamma_n = 2000.0\n[time]\nintegrator = \"split\"\n", 50.37,
            kind);
    Drive& drive = b.system.drive;
    drive = {.amplitude = 1, .omega = kTurn / 5};
    drive.recorded = std::make_shared<RecordedMotion>(samples, RecordInfo{.interval = 0.25, .start = 0});
    b.system.steps_per_period = static_cast<std::int64_t>(std::ceil(5 / b.system.dt));
    b.system.dt = 5 / static_cast<double>(b.system.steps_per_period);
    b.add(10, 0.5 - 1e-6, 0, b.system.plate_velocity());
    const auto overlap = [&] { return 0.5 + b.system.plate_height() - b.system.beads[0].z; };
    while (overlap() > 0) b.kernel->advance(b.system, 5);
    const std::string what = fmt::format("inelastic bead, recorded z = 2t - t^3/12, {}: ", name);
    validate({"V4.16", what + "take-off time, t0", 2, 0.01, "root of g + z'' = 0"}, b.system.time());
    validate({"V4.16", what + "speed of the bead then", 1, 0.01, "z'"}, b.system.beads[0].vz);
    double top = 0;
    while (b.system.time() < 4) {
      b.kernel->advance(b.system, 50);
      top = std::max(top, b.system.beads[0].z);
    }
    validate({"V4.16", what + "highest point of its centre, sigma", 0.5 + 10.0 / 3 + 0.5, 1e-3,
              "parabola of the flight"},
             top);
  }
}

/// Largest difference of height in the first flight between a bead on a plate that moves as 1.5 sin t and the
/// same bead on a plate whose drive is read from a file of `per_cycle` samples per cycle.
double largest_difference(const TemporaryFolder& folder, int per_cycle, const std::string& column,
                          bool repeats) {
  const int n = (repeats ? 1 : 3) * per_cycle + (repeats ? 0 : 1);
  std::string text = "time_t0," + column + "\n";
  for (int i = 0; i < n; ++i) {
    const double angle = kTurn * i / per_cycle, sign = column == "acceleration_g" ? -1 : 1;
    text += fmt::format("{:.15g},{:.15g}\n", angle, sign * 1.5 * std::sin(angle));
  }
  put_file(folder / "trace.csv", text);
  const std::string bed =
      "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 6.0\n[beads]\ncount = 1\n[time]\nsteps_per_contact = "
      "20\ndiscard = 0\ncycles = 2\nphases = 10\n[drive]\n";
  const auto run = [&](const std::string& drive) {
    Simulation simulation(read_scene_text(bed + drive, "s", {}, folder.path()));
    MemoryTrajectory frames(simulation.trajectory_info());
    simulation.run(frames);
    return frames;
  };
  const MemoryTrajectory sine = run("gamma = 1.5\n"),
                         recorded = run(fmt::format("file = \"trace.csv\"\nrepeat = {}\n", repeats));
  EXPECT_EQ(recorded.n_frames(), 20);
  double worst = 0;
  Frame a, b;
  for (std::size_t f = 0; f < 20; ++f) {
    sine.read(f, a);
    recorded.read(f, b);
    EXPECT_NEAR(a.time, b.time, 1e-9);
    EXPECT_NEAR(a.plate_height, b.plate_height, 1.5 * std::pow(kTurn / per_cycle, 4) / 100);
    constexpr std::size_t kLands = 7;  // frame
    if (f < kLands) worst = std::max(worst, std::abs(a.position[0].z() - b.position[0].z()));
  }
  return worst;
}

// The bead leaves the plate at arcsin(1/1.5) = 0.73 with its velocity, of which a spline through
// displacements errs by up to h^3/24 of the largest fourth derivative (Hall & Meyer 1976), and is in flight
// until 4.0.
TEST(RecordedDrive, ARecordedSineGivesTheFlightOfTheSine) {
  const TemporaryFolder folder;
  const double bound = 1.5 * std::pow(kTurn / 200, 3) / 24 * (0.6 * kTurn - std::asin(1 / 1.5));
  for (const char* column : {"position_sigma", "acceleration_g"})
    for (const bool repeats : {false, true}) {
      const double coarse = largest_difference(folder, 50, column, repeats),
                   fine = largest_difference(folder, 200, column, repeats);
      const std::string what =
          fmt::format("bead on a record of a sine with 200 samples per cycle ({}{}): ", column,
                      repeats ? ", repeated" : "");
      validate_bound({"V4.16", what + "difference of its height from the flight on the sine, over that bound",
                      0, 1, "error of a cubic spline"},
                     fine / bound);
      validate({"V4.16", what + "order in which the difference vanishes with the interval",
                column == std::string("acceleration_g") ? 4.0 : 3.0, 0.1,
                "velocity of a cubic spline, and its integral"},
               std::log(coarse / fine) / std::log(4.0));
    }
}

}  // namespace
}  // namespace twincell::sim::recorded_drive_test
