// The list solver against the all-pairs oracle, and against itself with other rebuild intervals: the same
// bits.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>

#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"
#include "sim/stepping/list_solver.hpp"
#include "tests/support/collision.hpp"

namespace twincell::sim::list_and_oracle_test {
namespace {

bool same_bits(const System& a, const System& b) {
  return a.beads.size() == b.beads.size() &&
         std::memcmp(a.beads.data(), b.beads.data(), a.beads.size() * sizeof(Bead)) == 0;
}

/// Creates a solver for a plan.
using Maker = std::function<std::unique_ptr<Solver>(const Plan&)>;
Maker of_kind(SolverKind kind, std::int64_t rebuild_every) {
  return [=](const Plan& plan) {
    auto kernel = make_solver(plan, {}, kind);
    kernel->rebuild_every(rebuild_every);
    return kernel;
  };
}

/// A shaken random bed after some thousand steps by the given solver. With several calls, each call uses a
/// new solver, to which the contact memory is passed.
System shaken(const std::string& extra, const Maker& make, int calls = 1) {
  const Scene scene = read_scene_text(
      "[beads]\ncount = 60\n[drive]\nomega = 1.0\ngamma = 3.0\n[start]\nkind = \"random\"\nseed = 5\n" +
          extra,
      "shaken");
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  for (Bead& b : s.beads) b.vz -= 2, b.vx *= 2, b.spin = b.vx;
  std::vector<ContactMemory> memories;
  for (int call = 0; call < calls; ++call) {
    const auto kernel = make(plan);
    kernel->restore(memories);
    kernel->advance(s, static_cast<std::int64_t>(240 * scene.steps_per_contact) / calls);
    memories = kernel->contacts();
  }
  return s;
}
System shaken(const std::string& extra, SolverKind kind, std::int64_t rebuild_every) {
  return shaken(extra, of_kind(kind, rebuild_every));
}

const std::string kPaperOne =
    "[cell]\nwidth = 8.0\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\n";
const std::string kPlateDrag =
    "[cell]\nwidth = 8.0\nplate_drag = 0.3\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = "
    "2e3\n";
const std::string kDashpot =
    "[cell]\nwidth = 8.0\nsides = \"periodic\"\n[contact]\nk_n = 1e5\nrestitution = 0.9\ntangential = "
    "\"dashpot\"\nc_t_over_c_n = 1.0\nmu = 0.4\n";
const std::string kSpace =
    "[cell]\ndimension = 3\nwidth = 3.0\ndepth = 3.0\n[contact]\nnormal = "
    "\"velocity-dependent-restitution\"\nk_n = "
    "1e5\n"
    "restitution_fast = 0.8\ngamma_t = 10.0\nk_t = 2e3\nrolling = \"spring\"\nk_r = 100.0\nmu_r = 0.1\n";
const std::string kSmooth =
    "[cell]\nwidth = 8.0\nsides = \"periodic\"\n[contact]\nk_n = 1e5\nrestitution = 0.9\ntangential = "
    "\"none\"\n";

/// Another integrator, with steps so long that lists are rebuilt while contacts begin and end.
std::string by(const std::string& integrator) {
  return "[time]\nsteps_per_contact = 10\nintegrator = \"" + integrator + "\"\n";
}

TEST(ListSolver, AgreesWithTheOracleToTheBit) {
  for (const auto& law :
       {kPaperOne, kPlateDrag, kDashpot, kSmooth, kPaperOne + by("predicted"), kPaperOne + by("split"),
        kPlateDrag + by("split"), kSmooth + by("split"), kSpace + by("split")})
    EXPECT_TRUE(same_bits(shaken(law, SolverKind::best, 0), shaken(law, SolverKind::all_pairs, 0))) << law;
}

TEST(AllPairsSolver, ManyContactsAtATimeHaveTheBitsOfOne) {
  const Maker wide = [](const Plan& plan) { return make_all_pairs_solver(plan, {}, widest_target()); };
  for (const auto& law : {kPaperOne, kDashpot, kSmooth, kPaperOne + by("predicted"), kPaperOne + by("split"),
                          kSpace + by("split")}) {
    const System oracle = shaken(law, SolverKind::all_pairs, 0);
    EXPECT_TRUE(same_bits(shaken(law, wide), oracle)) << law;
    EXPECT_TRUE(same_bits(shaken(law, wide, 3), oracle)) << law;
  }
}

// V2.14: contact history is neither lost nor duplicated
TEST(ListSolver, ResultIndependentOfListRebuildInterval) {
  for (const auto& law : {kPaperOne, kPlateDrag, kDashpot, kPaperOne + by("predicted"),
                          kPaperOne + by("split"), kSmooth + by("split"), kSpace + by("split")}) {
    const System seldom = shaken(law, SolverKind::best, 0);
    EXPECT_TRUE(same_bits(seldom, shaken(law, SolverKind::best, 1))) << law;
    EXPECT_TRUE(same_bits(seldom, shaken(law, SolverKind::best, 7))) << law;
  }
}

/// A dilute gas over a plate: most beads move freely for the whole life of a neighbour list and are then
/// advanced many steps at once.
System dilute(const std::string& dimension, SolverKind kind, std::int64_t rebuild_every, int calls) {
  const Scene scene = read_scene_text(
      "[cell]\nwidth = 60.0\n" + dimension +
          "[beads]\ncount = 1\n[contact]\nk_n = 1e3\nrestitution = 0.9\ntangential = "
          "\"dashpot\"\nc_t_over_c_n = "
          "1.0\nmu = 0.4\n[drive]\nomega = 1.0\ngamma = 1.5\n[time]\nsteps_per_contact = 12\n",
      "gas");
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> place(0, 1), speed(-3, 3);
  for (int i = 0; i < 61; ++i) {  // not a multiple of any group size
    Bead b;
    b.x = 0.5 + 0.97 * i, b.z = 0.6 + 12 * place(engine);
    if (scene.dimension == 3) b.y = 0.5 + 2.9 * place(engine);
    b.vx = speed(engine), b.vz = speed(engine), b.spin = speed(engine);
    s.beads.push_back(b);
  }
  const auto kernel = make_solver(plan, {.overlap = 0.4, .travel_per_step = 1}, kind);
  kernel->rebuild_every(rebuild_every);
  for (int k = 0; k < calls; ++k) kernel->advance(s, 4200 / calls);
  return s;
}

TEST(ListSolver, BeadsWithoutContactsFlyTheSame) {
  for (const std::string dimension :
       {"", "sides = \"periodic\"\n", "dimension = 3\ndepth = 4.0\n",
        "dimension = 3\ndepth = 4.0\nsides = \"periodic\"\nplates = \"periodic\"\n"}) {
    const System exact = dilute(dimension, SolverKind::all_pairs, 0, 1);
    EXPECT_TRUE(same_bits(exact, dilute(dimension, SolverKind::best, 0, 1))) << dimension;
    EXPECT_TRUE(same_bits(exact, dilute(dimension, SolverKind::best, 7, 1))) << dimension;
    EXPECT_TRUE(same_bits(exact, dilute(dimension, SolverKind::scalar, 0, 20))) << dimension;
    if (available(SolverKind::avx2)) {
      EXPECT_TRUE(same_bits(exact, dilute(dimension, SolverKind::avx2, 0, 3))) << dimension;
    }
  }
}

TEST(ListSolver, SameSceneSameBits) {
  EXPECT_TRUE(same_bits(shaken(kPaperOne, SolverKind::best, 0), shaken(kPaperOne, SolverKind::best, 0)));
}

TEST(ListSolver, FrictionOffIsTheSameAsMuZero) {  // EFFECTS: mu = 0 is bit for bit the same as no friction
  const System none = shaken(kSmooth, SolverKind::best, 0);
  const System zero = shaken(
      "[cell]\nwidth = 8.0\nsides = \"periodic\"\n[contact]\nk_n = 1e5\nrestitution = 0.9\ntangential = "
      "\"dashpot\"\nc_t = 100.0\nmu = 0.0\n",
      SolverKind::best, 0);
  EXPECT_TRUE(same_bits(none, zero));
}

// A frictional pair that crosses the periodic boundary while in contact behaves like one that does not.
TEST(ListSolver, HistoryCrossesThePeriodicBoundary) {
  auto run = [](double x) {
    Bench b("[cell]\ngravity = 1.0\nsides = \"periodic\"\nwidth = 8.0\n");
    b.add(x, 0.4999, 1, 0);
    b.add(x + 0.9999, 0.4999, 1, 0);
    b.advance_time(0.5);
    return b.system;
  };
  const System inside = run(2.0), across = run(6.8);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(inside.beads[i].x - 2.0, across.beads[i].x - 6.8, 1e-11);
    EXPECT_NEAR(inside.beads[i].spin, across.beads[i].spin, 1e-9);
  }
}

}  // namespace
}  // namespace twincell::sim::list_and_oracle_test
