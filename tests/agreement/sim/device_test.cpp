// The device kernel, compiled for the processor, against the oracle: the same bits for every combination of
// laws that it has, whatever the threads of a block, the launches and the lists.

#include <gtest/gtest.h>

#include <utility>

#include "core/error.hpp"
#include "sim/device/device_solver.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/dense_bed.hpp"

namespace twincell::sim::device_test {
namespace {

constexpr GuardLimits kLimits{.overlap = 0.3, .travel_per_step = 1};

struct Habits {
  HostThreads threads;
  std::int64_t rebuild_every = 0;
  std::int64_t piece = 1 << 30;  ///< steps per call
  bool one_call = false;         ///< with all pieces
};
Outcome on_device(const Plan& plan, System s, std::int64_t steps, const Habits& habits = {}) {
  Batcher batcher(make_host_executor(habits.threads));
  const auto solver = make_device_solver(plan, kLimits, batcher);
  solver->rebuild_every(habits.rebuild_every);
  std::vector<std::int64_t> pieces;
  for (std::int64_t done = 0; done < steps; done += habits.piece)
    pieces.push_back(std::min(habits.piece, steps - done));
  if (habits.one_call)
    solver->advance_in_pieces(s, pieces, [] {});
  else
    for (const std::int64_t piece : pieces) solver->advance(s, piece);
  return {std::move(s), solver->contacts()};
}
Outcome by_oracle(const Plan& plan, System s, std::int64_t steps) {
  const auto solver = make_solver(plan, kLimits, SolverKind::all_pairs);
  solver->advance(s, steps);
  return {std::move(s), solver->contacts()};
}

class Device : public testing::TestWithParam<Case> {
 protected:
  /// Calls check(plan, start, reference, name) for each combination of laws that has a device kernel. The
  /// reference is the result of the oracle.
  template <class Check>
  void for_each_law(std::int64_t steps, Check check) {
    int compared = 0;
    for (const LawWords& laws : all_laws()) {
      const Scene scene = scene_of(GetParam(), laws);
      const Plan plan = make_plan(scene);
      if (!find_device_kernel(plan.key)) continue;
      ++compared;
      const System start = bed_of(scene, plan);
      check(plan, start, by_oracle(plan, start, steps),
            laws.normal + ", " + laws.tangential + ", " + laws.rolling);
    }
    EXPECT_GE(compared, 8);
  }
};

TEST_P(Device, HasTheBitsOfTheOracle) {
  constexpr std::int64_t kSteps = 700;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 EXPECT_TRUE(same_bits(reference, on_device(plan, start, kSteps))) << name;
               });
}

TEST_P(Device, RebuildIntervalDoesNotChangeBits) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(
      kSteps, [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
        const auto same = [&](const Habits& habits) {
          return same_bits(reference, on_device(plan, start, kSteps, habits));
        };
        EXPECT_TRUE(same({.threads = {7, false}})) << name << ": blocks of 7 threads";
        EXPECT_TRUE(same({.threads = {32, true}})) << name << ": blocks of 32 threads, the last first";
        EXPECT_TRUE(same({.threads = {3, true}, .rebuild_every = 1})) << name << ": a list for every step";
        EXPECT_TRUE(same({.rebuild_every = 7})) << name << ": a list for every 7th step";
        EXPECT_TRUE(same({.piece = 1})) << name << ": a launch for every step";
        EXPECT_TRUE(same({.piece = 37})) << name << ": launches of 37 steps";
        EXPECT_TRUE(same({.piece = 7, .one_call = true})) << name << ": stops at every 7th step";
      });
}

TEST_P(Device, ARestartGivesTheSameBits) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 Outcome half = on_device(plan, start, kSteps / 3);
                 Batcher batcher(make_host_executor());
                 const auto other = make_device_solver(plan, kLimits, batcher);
                 other->restore(half.contacts);
                 other->advance(half.system, kSteps / 3);
                 // The rest by a solver of another kind, which reads the memory that this one writes.
                 const auto last = make_solver(plan, kLimits, SolverKind::scalar);
                 last->restore(other->contacts());
                 last->advance(half.system, kSteps - 2 * (kSteps / 3));
                 EXPECT_TRUE(same_bits(reference, {std::move(half.system), last->contacts()})) << name;
               });
}

// More beads than threads of a block, for so long that lists expire, with drag, on a plate that moves far.
TEST(DeviceSolver, KeepsItsListsOverALongRun) {
  const Scene scene = read_scene_text(
      "[cell]\nwidth = 12.0\nplate_drag = 0.3\n[beads]\ncount = 160\n[drive]\nomega = 1.0\ngamma = "
      "3.0\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\n[start]\nkind = "
      "\"random\"\n",
      "shaken");
  const Plan plan = make_plan(scene);
  System start = start_of(scene, plan);
  const std::int64_t steps = 2 * plan.steps_per_period;
  const Outcome reference = by_oracle(plan, start, steps);
  Batcher batcher(make_host_executor({.count = 128}));
  const auto solver = make_device_solver(plan, kLimits, batcher);
  System s = start;
  solver->advance(s, steps);
  EXPECT_TRUE(same_bits(reference, {s, solver->contacts()}));
  EXPECT_GT(solver->list_builds(), 5);
  EXPECT_LT(solver->list_builds(), steps / 50);
}

// What is seen at each stop is what separate calls give, also when a bead is too fast between two of them.
TEST(DeviceSolver, StopsShowTheSystemThere) {
  const Scene scene = read_scene_text(
      "[cell]\nwidth = 6.0\n[beads]\ncount = 40\n[drive]\nomega = 1.0\ngamma = 2.0\n[contact]\nk_n = "
      "1e5\ngamma_n = 10.0\n[start]\nkind = \"random\"\n",
      "shaken");
  const Plan plan = make_plan(scene);
  System start = start_of(scene, plan);
  const std::vector<std::int64_t> pieces = {3,  1,  1500, 40, 40, 40, 2,  900, 40, 40, 40, 40, 40, 40,
                                            40, 40, 40,   40, 40, 40, 40, 40,  40, 40, 40, 40, 40, 40};
  for (const bool too_fast : {false, true}) {
    if (too_fast) start.beads[3].vz = -600;
    const auto seen = [&](Solver& solver) {
      std::vector<System> at_stops;
      std::string failure;
      System s = start;
      try {
        solver.advance_in_pieces(s, pieces, [&] { at_stops.push_back(s); });
      } catch (const RunError& e) {
        failure = e.what();
      }
      return std::pair(at_stops, failure);
    };
    Batcher batcher(make_host_executor({.count = 128}));
    const auto [expected, failure] = seen(*make_solver(plan, kLimits, SolverKind::all_pairs));
    const auto [stops, device_failure] = seen(*make_device_solver(plan, kLimits, batcher));
    EXPECT_EQ(device_failure, failure);
    EXPECT_EQ(failure.empty(), !too_fast);
    ASSERT_EQ(stops.size(), expected.size());
    EXPECT_EQ(stops.size() < pieces.size(), too_fast);
    for (std::size_t k = 0; k < stops.size(); ++k)
      EXPECT_TRUE(same_bits({expected[k], {}}, {stops[k], {}})) << "stop " << k;
  }
}

TEST(DeviceSolver, OneBeadAndNoWalls) {
  for (const std::string text :
       {"[cell]\nwidth = 3.0\n[beads]\ncount = 1\n[drive]\nomega = 7.0\ngamma = 4.0\n",
        "[cell]\ndimension = 3\nwidth = 5.0\ndepth = 5.0\nheight = 5.0\ngravity = 0.0\nsides = "
        "\"periodic\"\nplates = \"periodic\"\nbottom = \"periodic\"\n[beads]\ncount = 40\n[drive]\namplitude "
        "= 0.0\nomega = 1.0\n"}) {
    const Scene scene = read_scene_text(text + "[time]\nstepping = \"steps\"\n", "gas");
    const Plan plan = make_plan(scene);
    const System start = bed_of(scene, plan);
    const Outcome reference = by_oracle(plan, start, 3000);
    EXPECT_TRUE(same_bits(reference, on_device(plan, start, 3000))) << text;
    EXPECT_NE(reference.system.beads[0].vz, start.beads[0].vz);
  }
}

/// On the card of this machine.
TEST(GraphicsCard, HasTheBitsOfTheOracle) {
  try {
    (void)gpu_batcher();
  } catch (const ConfigError& e) {
    GTEST_SKIP() << e.what();
  }
  constexpr std::int64_t kSteps = 700;
  for (const Case& c : all_cases())
    for (const LawWords& laws : all_laws()) {
      const Scene scene = scene_of(c, laws);
      const Plan plan = make_plan(scene);
      if (!find_device_kernel(plan.key)) continue;
      const Outcome reference = by_oracle(plan, bed_of(scene, plan), kSteps);
      System s = bed_of(scene, plan);
      const auto solver = make_device_solver(plan, kLimits, gpu_batcher());
      solver->advance(s, kSteps);
      EXPECT_TRUE(same_bits(reference, {std::move(s), solver->contacts()}))
          << testing::PrintToString(c) << ": " << laws.normal << ", " << laws.tangential;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Device, testing::ValuesIn(all_cases()), name_of_case);

}  // namespace
}  // namespace twincell::sim::device_test
