// The device kernel, compiled for the processor, against the oracle: the same bits for every combination of
// laws that it has, whatever the threads of a block, the launches and the lists.

#include <gtest/gtest.h>

#include <utility>

#include "sim/device/device_solver.hpp"
#include "sim/run/make_solver.hpp"
#include "tests/support/dense_bed.hpp"

namespace twincell::sim {
namespace {

constexpr GuardLimits kLimits{.overlap = 0.3, .travel_per_step = 1};

struct Habits {
  HostThreads threads;
  std::int64_t rebuild_every = 0;
  std::int64_t piece = 1 << 30;  ///< steps per call
};
Outcome on_device(const Plan& plan, System s, std::int64_t steps, const Habits& habits = {}) {
  Batcher batcher(make_host_executor(habits.threads));
  const auto solver = make_device_solver(plan, kLimits, batcher);
  solver->rebuild_every(habits.rebuild_every);
  for (std::int64_t done = 0; done < steps; done += habits.piece)
    solver->advance(s, std::min(habits.piece, steps - done));
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
    for (const Laws& laws : all_laws()) {
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

TEST_P(Device, HabitsDoNotShow) {
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
      });
}

TEST_P(Device, RestartDoesNotShow) {
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

INSTANTIATE_TEST_SUITE_P(All, Device, testing::ValuesIn(all_cases()), name_of_case);

}  // namespace
}  // namespace twincell::sim
