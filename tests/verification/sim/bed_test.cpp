// Beds of many beads, and single beads on the plate, against closed forms (docs/validation.md: V2.10, V3.9,
// V4.2-V4.4, V4.10).

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/validation.hpp"
#include "trajectory/temperature.hpp"

namespace twincell::sim::bed_test {
namespace {

using test::validate;

TEST(Bed, LoneBeadFliesAParabola) {
  Bench b("[contact]\ntangential = \"none\"\n");
  b.add(10, 50, 0.3, 1);
  b.kernel->advance(b.system, 20000);
  const double t = b.system.time();
  EXPECT_NEAR(b.system.beads[0].x, 10 + 0.3 * t, 1e-9);
  EXPECT_NEAR(b.system.beads[0].z, 50 + t - t * t / 2, 1e-9);
}

TEST(Bed, SlidingBecomesRolling) {  // V2.10: v = 2/3 v_0 for a disc
  for (const bool sphere : {false, true}) {
    Bench b("[contact]\nmu = 0.1\n", 50.37);
    b.add(5, 0.5 - 1e-6, 0.6, 0);  // resting overlap m g/k_n
    if (sphere) b.system.beads[0].inertia = 0.1;
    const double rolls = sphere ? 5.0 / 7 : 2.0 / 3, stop = 0.6 * (sphere ? 2.0 / 7 : 1.0 / 3) / 0.1;
    const std::string what = sphere ? "sphere thrown along the plate: " : "disc thrown along the plate: ";
    b.advance_time(0.9 * stop);  // the dashpot smooths the transition at the end
    const Bead& bead = b.system.beads[0];
    // The surface speed falls at the rate mu g (1 + m R^2/I).
    const double surface = 0.6 - 0.1 * b.system.time() / (1 - rolls);
    validate({"V2.10", what + "speed of its surface over v_0 at 0.9 of the sliding time", surface / 0.6, 0.01,
              "closed form"},
             (bead.vx + 0.5 * bead.spin) / 0.6);
    b.advance_time(0.6 * stop);
    validate({"V2.10", what + "rolling speed over v_0", rolls, 0.01 * rolls, "closed form"}, bead.vx / 0.6);
    validate({"V2.10", what + "surface's speed when it rolls", 0, 1e-3, "closed form"},
             bead.vx + 0.5 * bead.spin);
  }
}

TEST(Bed, ColumnCarriesItsWeight) {  // V4.2: overlap of contact i from the top = i m g/k_n
  constexpr int kBeads = 8;
  Bench b("[contact]\ntangential = \"none\"\n", 50.37);
  for (int i = 0; i < kBeads; ++i) b.add(10, 0.5 + i, 0, 0);
  b.advance_time(35);  // the slowest mode decays at about gamma (pi/2n)^2/4
  for (int i = 0; i < kBeads; ++i) {
    const double below = i == 0 ? 0.5 - b.system.beads[0].z
                                : 1 - (b.system.beads[static_cast<std::size_t>(i)].z -
                                       b.system.beads[static_cast<std::size_t>(i - 1)].z);
    if (i == 0 || i == kBeads / 2 || i == kBeads - 1)
      validate(
          {"V4.2",
           "column of 8, overlap below bead " + std::to_string(kBeads - i) + " from the top over m g/k_n",
           1.0 * (kBeads - i), 1e-8, "closed form"},
          below / 1e-6);
    EXPECT_NEAR(below, (kBeads - i) * 1e-6, 1e-14) << i;  // positions are rounded to 1e-15
  }
  double floor = 0;
  for (const Force& f : b.system.forces) floor += f.z;
  validate({"V4.2", "column of 8, force on the floor over its weight", 1, 1e-8, "closed form"},
           floor / kBeads);
}

Scene crystal(double gamma, int cycles) {
  return read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 100\n[cell]\nwidth = 10.0\n[drive]\ngamma = " +
          std::to_string(gamma) +
          "\n[time]\nsteps_per_contact = 20\ndiscard = 1\ncycles = " + std::to_string(cycles) + "\n",
      "crystal");
}

/// Standard deviation of the bed's mean height above the plate, over the cycle.
double bed_travel(const Scene& scene) {
  Simulation run(scene);
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  double sum = 0, squares = 0;
  for (const Frame& f : out.frames()) {
    double mean = 0;
    for (const Vec3& r : f.position) mean += r.z() / static_cast<double>(f.position.size());
    const double h = mean - f.plate_height;
    sum += h;
    squares += h * h;
  }
  const double n = static_cast<double>(out.n_frames());
  return std::sqrt(std::max(0.0, squares / n - sum * sum / n / n));
}

TEST(Bed, TakesOffAboveGammaOne) {  // V4.10
  const double below = bed_travel(crystal(0.9, 2)), above = bed_travel(crystal(1.1, 2));
  validate({"V4.10", "travel of the crystal on the plate, Gamma = 0.9", 0, 1e-3, "rigid bed"}, below);
  validate({"V4.10", "travel of the crystal on the plate, Gamma = 1.1", 0.0119, 6.9e-3, "rigid bed"}, above);
}

TEST(Bed, SmoothBedWeighsOnItsFloorAlone) {  // V4.3
  // Pair forces cancel exactly in the sum over beads, so the sum is the force of the walls.
  const auto walls = [](const System& s) {
    Vec3 sum = Vec3::Zero();
    for (const Force& f : s.forces) sum += Vec3(f.x, f.y, f.z);
    return sum;
  };
  for (const int dimension : {2, 3}) {
    const std::string size = dimension == 2 ? "width = 6.3\n" : "width = 3.4\ndepth = 3.3\n";
    const Scene scene = read_scene_text("[cell]\ndimension = " + std::to_string(dimension) + "\n" + size +
                                            "[beads]\ncount = 40\n[contact]\nk_n = 1e4\ngamma_n = "
                                            "200.0\ntangential = \"none\"\n[drive]\namplitude = "
                                            "0.5\nomega = 3.0\n[start]\nkind = \"random\"\n",
                                        "smooth bed");
    const Plan plan = make_plan(scene);
    System s = make_system(scene, plan);
    s.beads = make_start(scene).beads;
    const auto kernel = make_solver(plan, {});
    const auto momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (const Bead& b : s.beads) sum += Vec3(b.vx, b.vy, b.vz);
      return sum;
    };
    // The bed is shaken for two periods. By the momentum theorem, the mean wall force is the weight plus the
    // rate of change of the momentum.
    kernel->advance(s, 1);
    const Vec3 before = momentum();
    const double start = s.time();
    Vec3 impulse = 0.5 * s.dt * walls(s);
    for (std::int64_t k = 0; k < 2 * s.steps_per_period; ++k) {
      kernel->advance(s, 1);
      impulse += s.dt * walls(s);
    }
    impulse -= 0.5 * s.dt * walls(s);
    const double time = s.time() - start;
    const Vec3 force = (impulse - (momentum() - before)) / time;
    const std::string what = "smooth driven bed of 40, " + std::to_string(dimension) + "D: ";
    validate(
        {"V4.3", what + "mean vertical wall force less momentum gained, over N m g", 1, 1e-8, "momentum"},
        force.z() / 40);
    validate(
        {"V4.3", what + "mean sideways wall force less momentum gained, over N m g", 0, 1e-8, "momentum"},
        std::hypot(force.x(), force.y()) / 40);
    s.drive.amplitude = 0;
    kernel->advance(s, static_cast<std::int64_t>(300 / s.dt));
    impulse = Vec3::Zero();
    for (int k = 0; k < 1000; ++k) {
      kernel->advance(s, 1);
      impulse += walls(s) / 1000;
    }
    validate({"V4.3", what + "floor force at rest over N m g", 1, 1e-8, "closed form"}, impulse.z() / 40);
    validate({"V4.3", what + "net force of the side walls at rest over N m g", 0, 1e-8, "closed form"},
             std::hypot(impulse.x(), impulse.y()) / 40);
  }
}

/// Fraction of the weight that the floor carries, and the height of the bed.
struct Silo {
  double share = 0, height = 0;
};
constexpr double kSiloWidth = 5.3, kSiloFriction = 0.6;

/// Pours a bed into a narrow cell, then lowers the floor slightly between walls at rest, so that wall
/// friction is fully mobilised.
Silo sinking_floor(int layers, int seed) {
  const Scene scene =
      read_scene_text("[cell]\nwidth = " + std::to_string(kSiloWidth) +
                          "\nside_walls = \"rest\"\n[beads]\ncount = " + std::to_string(5 * layers) +
                          "\n[contact]\nk_n = 1e5\nk_t = 3e4\nrestitution = 0.5\ngamma_t = 50.0\nmu = " +
                          std::to_string(kSiloFriction) +
                          "\n[drive]\nomega = 0.2\namplitude = 0.1\n[start]\nkind = \"random\"\nseed = " +
                          std::to_string(seed) + "\n[time]\nsteps_per_contact = 20\n",
                      "silo");
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  const auto kernel = make_solver(plan, {});
  const Drive sinking = s.drive;
  s.drive.amplitude = 0;
  kernel->advance(s, static_cast<std::int64_t>((30 + layers) / s.dt));
  s.step = s.steps_per_period / 2,
  s.drive = sinking;  // the plate moves down from here, for a quarter of the cycle
  kernel->advance(s, s.steps_per_period / 4 - 2000);
  const double n = static_cast<double>(s.beads.size());
  Silo silo;
  for (int k = 0; k < 20; ++k) {
    kernel->advance(s, 100);
    for (const Bead& b : s.beads)
      silo.share += 1e5 * std::max(0.0, 0.5 - (b.z - s.plate_height())) / (20 * n);
  }
  // The height of a uniform column is twice the height of its centre of mass.
  for (const Bead& b : s.beads) silo.height += 2 * (b.z - s.plate_height()) / n;
  return silo;
}

TEST(Bed, WallsCarryTallBeds) {  // V4.4, Janssen: the force on the floor saturates with height
  constexpr int kPackings = 6;
  // Two standard errors: the carried fraction varies by 0.1 from one packing to the next.
  const double tolerance = 2 * 0.1 / std::sqrt(kPackings);
  const double sin_squared = kSiloFriction * kSiloFriction / (1 + kSiloFriction * kSiloFriction);
  const double stress_ratio = (1 - sin_squared) / (1 + sin_squared);  // Krynine 1945
  for (const int layers : {10, 20, 40, 80}) {
    double share = 0, height = 0;
    for (int seed = 1; seed <= kPackings; ++seed) {
      const Silo silo = sinking_floor(layers, seed);
      share += silo.share / kPackings, height += silo.height / kPackings;
    }
    const double x = 2 * kSiloFriction * stress_ratio * height / kSiloWidth, janssen = (1 - std::exp(-x)) / x;
    validate(
        {"V4.4", "mu = 0.6, " + std::to_string(layers) + " layers in a cell 5 wide, floor force over weight",
         janssen, tolerance, "Janssen 1895, Krynine 1945"},
        share);
  }
}

TEST(Bed, ColumnOfGasIsBarometric) {  // V3.9: density ~ exp(-m g z/T), from a start far from equilibrium
  constexpr int kBeads = 300, kLooks = 1000;
  constexpr double kWidth = 7800;
  const Scene scene = read_scene_text(
      "[cell]\nwidth = 7800.0\nsides = \"periodic\"\n[beads]\ncount = 1\n[contact]\ntangential = "
      "\"none\"\nk_n = 1e3\n[drive]\namplitude = 0.0\nomega = 1.0\n",
      "column");
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  s.dt = std::numbers::pi / std::sqrt(2 * 1e3) / 12.37;
  // All beads start with the same energy, 6 m g sigma, as height or as motion, so the start contains no
  // Boltzmann factor.
  std::mt19937_64 engine(9);
  std::uniform_real_distribution<double> place(0, 1);
  for (int i = 0; i < kBeads; ++i) {
    Bead b;
    b.x = kWidth / kBeads * (i + 0.9 * place(engine)), b.z = 0.5 + 5.5 * place(engine);
    const double v = std::sqrt(2 * (6.5 - b.z)), angle = 2 * std::numbers::pi * place(engine);
    b.vx = v * std::cos(angle), b.vz = v * std::sin(angle);
    s.beads.push_back(b);
  }
  const auto kernel = make_solver(plan, {.overlap = 0.4, .travel_per_step = 1});
  const auto run = [&](double time) { kernel->advance(s, static_cast<std::int64_t>(time / s.dt)); };
  run(400);
  double heat = 0;
  std::vector<double> heights;
  for (int look = 0; look < kLooks; ++look) {
    run(6);
    for (const Bead& b : s.beads) {
      heat += 0.5 * (b.vx * b.vx + b.vz * b.vz) / (kBeads * kLooks);
      if (b.z > 0.5) heights.push_back(b.z - 0.5);
    }
  }
  // The decay length over two decades of density, by maximum likelihood for a truncated exponential.
  const double top = std::log(100.0) * heat;
  double mean = 0, inside = 0;
  for (const double z : heights)
    if (z < top) mean += z, ++inside;
  mean /= inside;
  double low = 0.5 * heat, high = 2 * heat;
  for (int i = 0; i < 60; ++i) {
    const double h = (low + high) / 2;
    (h - top / std::expm1(top / h) < mean ? low : high) = h;
  }
  // With the second virial coefficient, ln(phi) + 4 phi falls by m g z/T: the mean height is 1 + phi_0.
  const double floor = kBeads * std::numbers::pi / 4 / (kWidth * heat);
  validate(
      {"V3.9",
       "gas under gravity, phi = 0.01 at the floor: decay length of the density over T/(m g), two decades",
       1 + floor, 0.02, "Boltzmann; second virial coefficient"},
      low / heat);
  for (int bin = 0; bin < 4; ++bin) {
    double count = 0;
    for (const double z : heights) count += z >= bin * heat && z < (bin + 1) * heat;
    const double exact = std::exp(-bin) * -std::expm1(-1.0) * static_cast<double>(heights.size());
    // The tolerance is 4 phi_0 plus three standard errors of a count whose samples are half independent.
    validate(
        {"V3.9",
         "gas under gravity: beads in layer " + std::to_string(bin + 1) + " of height T/(m g), over exact", 1,
         4 * floor + 3 * std::sqrt(2 / exact), "Boltzmann"},
        count / exact);
  }
}

TEST(Bed, DriveReturnsToTheSameBitsEveryPeriod) {
  Simulation run(crystal(1.5, 3));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  EXPECT_EQ(run.plan().steps_per_period % run.scene().phases, 0);
  for (std::size_t f = 20; f < out.n_frames(); ++f) {
    EXPECT_EQ(out.frames()[f].plate_height, out.frames()[f - 20].plate_height);
    EXPECT_EQ(out.frames()[f].phase, static_cast<int>(f % 20));
    EXPECT_EQ(out.frames()[f].cycle, static_cast<std::int64_t>(f / 20));
  }
}

TEST(Bed, TimeMeansAreThoseOfDenseFrames) {
  const auto film = [](const char* phases, const char* samples) {
    const Simulation settled(read_scene_text(
        "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 4\n[cell]\nwidth = 10.0\n[drive]\ngamma = 2.2\n",
        "landing",
        {"time.discard=1", "time.cycles=3", "time.steps_per_contact=49.95",
         std::string("time.phases=") + phases, std::string("time.samples=") + samples}));
    Simulation run(settled.scene(), settled.state());
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    EXPECT_EQ(run.plan().steps_per_period % 400, 0);  // otherwise the two would sample different instants
    return out;
  };
  const MemoryTrajectory sparse = film("20", "400"), dense = film("400", "0");
  EXPECT_EQ(sparse.info().samples_per_cycle, 400);
  EXPECT_FALSE(dense.info().columns.time_mean);
  EXPECT_TRUE(dense.frames().back().time_mean.temperature.hasNaN());
  const auto& mass = dense.info().mass;
  double largest = 0;
  for (std::size_t f = 1; f < sparse.n_frames(); ++f) {
    Vec3 all = Vec3::Zero(), coarse = Vec3::Zero();
    for (std::size_t k = 20 * f - 19; k <= 20 * f; ++k) {
      const Vec3 t = temperature_components(dense.frames()[k], mass);
      all += t / 20;
      if (k % 2 == 0) coarse += t / 10;
    }
    const TimeMean& mean = sparse.frames()[f].time_mean;
    largest = std::max(largest, mean.temperature.norm());
    EXPECT_LE((mean.temperature - all).norm(), 1e-12);
    EXPECT_LE((mean.temperature_coarse - coarse).norm(), 1e-12);
  }
  EXPECT_GT(largest, 0.01);  // a bed at rest would make the comparison empty
}

TEST(Bed, SmoothBeadsHaveNoSpinColumn) {
  const Simulation run(
      read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[contact]\nmu = 0.0\n"
                      "[drive]\ngamma = 1.5\n[time]\ndiscard = 0\ncycles = 1\n",
                      "smooth"));
  EXPECT_FALSE(run.plan().rotation);
  EXPECT_FALSE(run.plan().history);
  EXPECT_FALSE(run.trajectory_info().columns.spin);
}

}  // namespace
}  // namespace twincell::sim::bed_test
