// Runs whose drive changes, and runs whose cell also moves along x (docs/validation.md: V4.17, V4.18).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/validation.hpp"

namespace twincell::sim::moving_drive_test {
namespace {

using test::validate;
using test::validate_bound;
constexpr double kTurn = 2 * std::numbers::pi;

MemoryTrajectory run(const std::string& scene, std::int64_t* first = nullptr) {
  Simulation simulation(read_scene_text(scene, "s"));
  if (first != nullptr) *first = simulation.plan().cycles_before;
  MemoryTrajectory frames(simulation.trajectory_info());
  simulation.run(frames);
  return frames;
}

// Gamma rises from 0.8 by 0.02 a cycle: at phase 1/4, where the plate falls fastest, it is 0.985 in cycle 9
// and 1.005 in cycle 10. An inelastic bead leaves the plate in cycle 10 first.
TEST(Ramp, ABeadLeavesThePlateInTheFirstCycleOfGammaAboveOne) {
  const MemoryTrajectory frames =
      run("[cell]\nwidth = 2.0\n[beads]\ncount = 1\n[contact]\ntangential = \"none\"\ngamma_n = 500.0\n"
          "[drive]\ngamma = 0.8\nomega = 1.0\n[drive.ramp]\ngamma = 1.2\n[time]\ndiscard = 2\ncycles = "
          "20\nphases = 100\nsamples = 0\n");
  std::int64_t left = -1;
  double closest = -1;
  for (const Frame& f : frames.frames()) {
    const double gap = f.position[0].z() - 0.5 - f.plate_height;
    if (left < 0 && gap > 0) left = f.cycle;
    if (f.cycle < 10) closest = std::max(closest, gap);
  }
  validate({"V4.17", "inelastic bead, Gamma from 0.8 to 1.2 in 20 cycles: first cycle in which it leaves", 10,
            0, "Gamma sin(pi/2) = 1"},
           static_cast<double>(left));
  validate_bound(
      {"V4.17", "the same bead, cycles 0 to 9: largest gap below it, sigma", -1e-4, 0, "Gamma < 1"}, closest);
}

// The frequency rises from 0.5/t0 to 1/t0 at constant Gamma = 0.9: a bead rides on the plate, whose motion is
// a chirp. Frames are at the steps nearest to their phases.
TEST(Ramp, ABeadRidesOnAChirp) {
  std::int64_t first = 0;
  const MemoryTrajectory frames =
      run("[cell]\nwidth = 2.0\n[beads]\ncount = 1\n[contact]\ntangential = \"none\"\ngamma_n = 500.0\n"
          "[drive]\ngamma = 0.9\nfrequency = 0.5\n[drive.ramp]\nfrequency = 1.0\n[time]\ndiscard = 1\ncycles "
          "= 12\n"
          "phases = 20\n",
          &first);
  ASSERT_EQ(frames.n_frames(), 240);
  const double w0 = kTurn / 2, w1 = kTurn, duration = 2 * kTurn * 12 / (w0 + w1);
  double speed = 0, height = 0, late = 0, sampled = 0;
  for (const Frame& f : frames.frames()) {
    const double t = f.time - static_cast<double>(first) * 2;  // the cycle before the ramp takes 2 t0
    const double angle = w0 * t + (w1 - w0) * t * t / (2 * duration), omega = w0 + (w1 - w0) * t / duration;
    const double a = 0.9 / (omega * omega), slope = -2 * a * (w1 - w0) / duration / omega;
    height = std::max(height, std::abs(f.plate_height - a * std::sin(angle)));
    speed = std::max(speed,
                     std::abs(f.velocity[0].z() - (slope * std::sin(angle) + a * omega * std::cos(angle))));
    late = std::max(late, std::abs(angle / kTurn - (static_cast<double>(f.cycle) + f.phase / 20.0)));
    if (std::isfinite(f.time_mean.temperature.z())) ++sampled;
  }
  validate({"V4.17", "chirp of 12 cycles at Gamma = 0.9: error of the plate's height in the frames, sigma", 0,
            1e-9, "A(t) sin of the integral of omega"},
           height);
  validate({"V4.17", "bead on that chirp: difference of its velocity from the plate's, sigma/t0", 0, 5e-5,
            "derivative of that motion"},
           speed);
  validate({"V4.17", "frames of that chirp: distance from their phase, cycles", 0, 1e-4, "half a step"},
           late);
  EXPECT_GE(sampled, 238);  // time averages are those between frames
  const Frame& last = frames.frames().back();
  EXPECT_NEAR(last.time + (1 - 0.95) / 1.0, 2 + duration, 1e-2);
}

// A run that is stopped and goes on, here after every seventh frame, is the run itself to the bit.
TEST(Ramp, ARunInPiecesIsTheRun) {
  const std::string bed =
      "[cell]\nwidth = 5.0\n[beads]\ncount = 12\n[drive]\ngamma = 1.5\nfrequency = "
      "0.3\n[drive.ramp]\nfrequency "
      "= 0.6\ngamma = 2.5\nreturn = true\n[time]\ndiscard = 1\ncycles = 2\nphases = 20\n";
  const MemoryTrajectory whole = run(bed);
  Simulation first(read_scene_text(bed, "s"));
  MemoryTrajectory frames(first.trajectory_info());
  first.run(frames, Progress::none(), 7);
  Simulation second(read_scene_text(bed, "s"), first.state());
  while (frames.n_frames() < 40) second.run(frames, Progress::none(), 7);
  ASSERT_EQ(whole.n_frames(), 40);
  for (std::size_t f = 0; f < 40; ++f) {
    EXPECT_EQ(whole.frames()[f].step, frames.frames()[f].step);
    EXPECT_EQ(whole.frames()[f].plate_height, frames.frames()[f].plate_height);
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_EQ(whole.frames()[f].position[i], frames.frames()[f].position[i]) << f << " " << i;
  }
}

const std::string kBox =
    "[cell]\nwidth = 1.0\n[beads]\ncount = 1\n[contact]\ntangential = \"none\"\nk_n = 1e5\ngamma_n = 500.0\n"
    "[start]\nkind = \"crystal_a\"\n[time]\ndiscard = 1\ncycles = 3\nphases = 40\ncontacts = true\n";

// A bead between walls one diameter apart has no freedom along x: the walls carry it, with the force
// -X (n omega)^2 sin(n omega t + 2 pi phi).
TEST(HorizontalDrive, SideWallsCarryABead) {
  const MemoryTrajectory frames = run(kBox +
                                      "[drive]\namplitude = 0.1\nomega = 1.0\n[drive.horizontal]\namplitude "
                                      "= 0.5\nratio = 2\nphase = 0.25\n");
  double off = 0, faster = 0, force = 0, weight = 0;
  for (const Frame& f : frames.frames()) {
    const double angle = 2 * kTurn * f.phase / 40 + kTurn / 4;
    off = std::max(off, std::abs(f.position[0].x() - 0.5 - 0.5 * std::sin(angle)));
    faster = std::max(faster, std::abs(f.velocity[0].x() - std::cos(angle)));
    double x = 0, z = 0;
    for (const ContactForce& c : f.contact_forces) x += c.force().x(), z += c.force().z();
    force = std::max(force, std::abs(x + 2 * std::sin(angle)));
    weight = std::max(weight, std::abs(z - 1 + 0.1 * std::sin(kTurn * f.phase / 40)));
  }
  const std::string what = "bead between walls one diameter apart, X = 0.5, n = 2, phi = 1/4: ";
  validate(
      {"V4.18", what + "distance from the middle of the cell, sigma", 0, 1e-4, "X sin(n omega t + 2 pi phi)"},
      off);
  validate({"V4.18", what + "difference of velocities, sigma/t0", 0, 2e-4, "its derivative"}, faster);
  validate({"V4.18", what + "error of the walls' force, m g", 0, 5e-4, "-X (n omega)^2 sin"}, force);
  validate({"V4.18", what + "error of the plate's force, m g", 0, 5e-4, "1 - A omega^2 sin(omega t)"},
           weight);
}

// Rolling without slip: a disc on a plate that accelerates along x has I/(I + m R^2) = 1/3 of its
// acceleration, a sphere 2/7, as long as friction suffices.
TEST(HorizontalDrive, FrictionRollsABeadOnThePlate) {
  for (const auto& [dimension, share] : {std::pair{2, 1.0 / 3}, {3, 2.0 / 7}}) {
    const MemoryTrajectory frames = run(fmt::format(
        "[cell]\ndimension = {}\nwidth = 6.0\n{}sides = \"periodic\"\n[beads]\ncount = 1\n[contact]\nmu = "
        "0.6\n"
        "k_n = 1e5\nk_t = 5e4\ngamma_n = 300.0\ngamma_t = 300.0\n[drive]\namplitude = 0.0\nomega = 1.0\n"
        "[drive.horizontal]\namplitude = 0.5\n[time]\ndiscard = 0\ncycles = 2\nphases = 20\n",
        dimension, dimension == 3 ? "depth = 6.0\nplates = \"periodic\"\n" : ""));
    double off = 0, spin = 0;
    for (const Frame& f : frames.frames()) {
      const double plate = 0.5 * std::cos(kTurn * f.phase / 20);
      // It starts with the velocity 0.5 of the plate, without spin.
      const double v = 0.5 + share * (plate - 0.5);
      off = std::max(off, std::abs(f.velocity[0].x() - v));
      spin =
          std::max(spin, std::abs(f.spin[0].y() * 0.5 - (v - plate)));  // v - R spin = plate at the contact
    }
    const std::string what =
        fmt::format("{} on a plate that moves along x: ", dimension == 2 ? "disc" : "sphere");
    validate({"V4.18", what + "error of its velocity, sigma/t0", 0, 2e-5, "a = a_plate I/(I + m R^2)"}, off);
    validate({"V4.18", what + "slip, sigma/t0", 0, 2e-5, "rolling without slip"}, spin);
  }
}

// A cell that only moves along x, stated in the two possible ways.
TEST(HorizontalDrive, IsTheDriveAlongXIfNothingMovesAlongZ) {
  const std::string bed =
      "[cell]\nwidth = 4.0\n[beads]\ncount = 12\n[time]\ndiscard = 0\ncycles = 1\nphases = 20\n";
  const MemoryTrajectory one = run(bed + "[drive]\naxis = \"x\"\namplitude = 0.8\nomega = 2.0\n"),
                         two = run(
                             bed +
                             "[drive]\namplitude = 0.0\nomega = 2.0\n[drive.horizontal]\namplitude = 0.8\n");
  ASSERT_EQ(one.n_frames(), two.n_frames());
  double moved = 0;
  for (std::size_t f = 0; f < one.n_frames(); ++f)
    for (std::size_t i = 0; i < 12; ++i) {
      const Vec3& a = one.frames()[f].position[i];
      EXPECT_NEAR((a - two.frames()[f].position[i]).norm(), 0, 1e-9) << f << " " << i;
      moved = std::max(moved, (a - one.frames()[0].position[i]).norm());
    }
  EXPECT_GT(moved, 0.5);
}

/// A bead in a box of one diameter without gravity, which moves by 0.5 sin(2t) along z and by
/// 0.5 sin(2t + 2 pi phase) along x.
MemoryTrajectory in_a_box(double phase) {
  return run(
      fmt::format("[cell]\nwidth = 1.0\nheight = 1.0\nlid = \"wall\"\ngravity = 0.0\n[beads]\ncount = "
                  "1\n[contact]\ntangential = \"none\"\nk_n = 1e5\ngamma_n = 500.0\n[drive]\namplitude = "
                  "0.5\nomega = 2.0\n[drive.horizontal]\namplitude = 0.5\nphase = {}\n[time]\ndiscard = "
                  "1\ncycles = 2\nphases = 40\ncontacts = true\n",
                  phase));
}

Vec3 force_of(const Frame& f) {
  Vec3 force = Vec3::Zero();
  for (const ContactForce& c : f.contact_forces) force += c.force();
  return force;
}

// On a circle of radius 0.5 the walls hold the bead with a constant force that turns.
TEST(HorizontalDrive, ACircleIsAConstantForceThatTurns) {
  double least = INFINITY, most = 0, off = 0;
  const MemoryTrajectory run = in_a_box(0.25);
  for (const Frame& f : run.frames()) {
    least = std::min(least, force_of(f).norm());
    most = std::max(most, force_of(f).norm());
    const double angle = kTurn * f.phase / 40;
    const Vec3& r = f.position[0];
    off = std::max(off, (r - Vec3(0.5 + 0.5 * std::cos(angle), r.y(), 0.5 + 0.5 * std::sin(angle))).norm());
  }
  const std::string what = "bead in a box on a circle of radius 0.5, omega = 2: ";
  validate({"V4.18", what + "least force, m g", 2, 5e-4, "m X omega^2"}, least);
  validate({"V4.18", what + "largest force, m g", 2, 5e-4, "m X omega^2"}, most);
  validate({"V4.18", what + "distance from the circle, sigma", 0, 1e-4, "co-moving cell"}, off);
}

// In phase, the two motions are one along the diagonal: the force has no component across it.
TEST(HorizontalDrive, InPhaseItIsATiltedVibration) {
  double along = 0, across = 0;
  const MemoryTrajectory run = in_a_box(0);
  for (const Frame& f : run.frames()) {
    const Vec3 force = force_of(f);
    const double expected = -std::sqrt(2.0) * 2 * std::sin(kTurn * f.phase / 40);
    along = std::max(along, std::abs((force.x() + force.z()) / std::sqrt(2.0) - expected));
    across = std::max(across, std::abs(force.x() - force.z()));
  }
  const std::string what = "bead in a box that moves along its diagonal: ";
  validate({"V4.18", what + "error of the force along it, m g", 0, 5e-4, "-sqrt(2) m A omega^2 sin(omega t)"},
           along);
  validate({"V4.18", what + "force across it, m g", 0, 1e-6, "symmetry"}, across);
}

}  // namespace
}  // namespace twincell::sim::moving_drive_test
