// Changes that must not affect the bits or the speed of a run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <ctime>
#include <fstream>
#include <sstream>

#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shaken_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim::bits_test {
namespace {

/// The frames of a trajectory file that the program wrote.
std::vector<Frame> frames_of(const std::filesystem::path& file) {
  const H5mdReader reader(file);
  std::vector<Frame> all(reader.n_frames());
  for (std::size_t f = 0; f < all.size(); ++f) reader.read(f, all[f]);
  return all;
}

void expect_same_frames(const std::vector<Frame>& a, const std::vector<Frame>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t f = 0; f < a.size(); ++f) {
    EXPECT_EQ(a[f].position, b[f].position) << f;
    EXPECT_EQ(a[f].velocity, b[f].velocity) << f;
    EXPECT_EQ(a[f].spin, b[f].spin) << f;
  }
}

/// Runs the program on a moving bed and returns the frames.
std::vector<Frame> program(const std::vector<std::string>& more) {
  const TemporaryFolder folder;
  std::ofstream(folder / "scene.toml")
      << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 90\n[cell]\nwidth = "
         "10.0\n[drive]\ngamma = 2.5\n[start]\nkind = \"random\"\nsettle_limit = "
         "2\n[time]\nsteps_per_contact = 10\ndiscard = 0\ncycles = 1\n";
  std::vector<std::string> words = {"simulate", (folder / "scene.toml").string(), "-q", "-o",
                                    (folder / "out.h5").string()};
  words.insert(words.end(), more.begin(), more.end());
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, 0) << ran.err;
  return frames_of(folder / "out.h5");
}

TEST(Bits, SameSceneGivesTheSameBits) {
  expect_same_frames(program({}), program({}));
}

TEST(Bits, OnlyASeededPerturbationMakesEnsembles) {
  const std::string little = "start.perturbation=1e-9";
  const auto one = program({"--set", little, "--seed", "4"}),
             again = program({"--set", little, "--seed", "4"}),
             other = program({"--set", little, "--seed", "5"});
  expect_same_frames(one, again);
  EXPECT_NE(one[0].position, other[0].position);
}

TEST(Bits, NarrowPeriodicCellAgreesWithTheOracle) {  // 2.5 diameters: no second image is within range
  for (const char* width : {"2.5", "2.6", "5"}) {
    const std::vector<std::string> set = {"beads.count=20", "cell.sides=periodic",
                                          std::string("cell.width=") + width};
    ShakenBed list(set), oracle(set, SolverKind::all_pairs);
    list.advance(30000), oracle.advance(30000);
    EXPECT_TRUE(same_bits(list.system, oracle.system)) << width;
  }
}

TEST(Bits, ListMissesNoContact) {  // lists rebuilt at every step and only when due, 1e5 steps
  ShakenBed due, always;
  always.kernel->rebuild_every(1);
  for (int k = 0; k < 100; ++k) {
    due.advance(1000), always.advance(1000);
    ASSERT_TRUE(same_bits(due.system, always.system)) << k;
    for (std::size_t i = 0; i < due.system.forces.size(); ++i)
      ASSERT_EQ(std::memcmp(&due.system.forces[i], &always.system.forces[i], sizeof(Force)), 0) << k;
  }
  EXPECT_GT(always.kernel->list_builds(), 100 * due.kernel->list_builds());
}

TEST(Bits, IndependentOfTheOrderInMemory) {  // the oracle never sorts; output is in bead order
  ShakenBed sorted, unsorted({}, SolverKind::all_pairs);
  const double first = sorted.system.beads[0].radius;
  sorted.advance(30000), unsorted.advance(30000);
  EXPECT_TRUE(same_bits(sorted.system, unsorted.system));
  EXPECT_EQ(sorted.system.beads[0].radius, first);
}

TEST(Bits, IndependentOfTheNumberOfThreads) {
  const auto one = program({"--threads", "1"});
  for (const char* threads : {"2", "3", "8"}) expect_same_frames(one, program({"--threads", threads}));
}

TEST(Bits, IndependentOfTheWidthOfVectors) {
  ShakenBed scalar({}, SolverKind::scalar);
  scalar.advance(30000);
  for (const SolverKind kind : {SolverKind::avx2, SolverKind::avx512}) {
    if (!available(kind)) continue;
    ShakenBed vectors({}, kind);
    vectors.advance(30000);
    EXPECT_TRUE(same_bits(scalar.system, vectors.system));
  }
}

bool any_subnormal(const System& s) {
  for (const Bead& b : s.beads)
    for (const double v : {b.x, b.y, b.z, b.vx, b.vy, b.vz, b.spin, b.spin_x, b.spin_z})
      if (v != 0 && std::abs(v) < DBL_MIN) return true;
  return false;
}

TEST(Bits, SettledBedIsNotSlowedBySubnormals) {
  // Drag reduces a velocity to 1e-308 in 71 t0, and then through the subnormal numbers to 0.
  ShakenBed bed({"cell.plate_drag=10", "contact.mu=0", "drive.gamma=0", "cell.sides=periodic"});
  const auto seconds = [&](std::int64_t steps) {  // the fastest of five runs
    double best = HUGE_VAL;
    for (int k = 0; k < 5; ++k) {
      const auto begin = std::clock();
      bed.advance(steps);
      best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    return best;
  };
  double before = 0, after = 0;  // the slowest time until velocities are small, and after that
  for (int k = 0; k < 60; ++k) {
    bed.advance(static_cast<std::int64_t>(1.5 / bed.system.dt));
    double& slowest = bed.system.time() < 60 ? before : after;
    slowest = std::max(slowest, seconds(2000));
    EXPECT_FALSE(any_subnormal(bed.system)) << "at " << bed.system.time();
  }
  std::printf("a step at rest takes %.2f of one before\n", after / before);
  EXPECT_GT(bed.system.time(), 85);
  EXPECT_LT(after, 3 * before);
}

}  // namespace
}  // namespace twincell::sim::bits_test
