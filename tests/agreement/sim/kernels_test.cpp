// For every combination of laws, dimension, integrator, sizes and boundaries, all solvers give the same bits.
// The result also does not depend on when neighbour lists are rebuilt, how threads share the work, how beads
// are numbered, or how a run is divided into calls.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "tests/support/dense_bed.hpp"

namespace twincell::sim::kernels_test {
namespace {

struct Habits {
  SolverKind kind = SolverKind::scalar;
  int threads = 1;
  std::int64_t rebuild_every = 0;
  std::int64_t piece = 1 << 30;  ///< steps per call
};
Outcome run(const Plan& plan, System s, std::int64_t steps, const Habits& habits) {
  const auto kernel = make_solver(plan, {.overlap = 0.3, .travel_per_step = 1}, habits.kind, habits.threads);
  kernel->rebuild_every(habits.rebuild_every);
  for (std::int64_t done = 0; done < steps; done += habits.piece)
    kernel->advance(s, std::min(habits.piece, steps - done));
  return {std::move(s), kernel->contacts()};
}

class Kernels : public testing::TestWithParam<Case> {
 protected:
  /// Calls check(plan, start, reference, name) for each combination of laws. The reference is the result of
  /// the scalar solver.
  template <class Check>
  void for_each_law(std::int64_t steps, Check check) {
    for (const LawWords& laws : all_laws()) {
      const Scene scene = scene_of(GetParam(), laws);
      const Plan plan = make_plan(scene);
      const System start = bed_of(scene, plan);
      const Outcome reference = run(plan, start, steps, {});
      const std::string name = laws.normal + ", " + laws.tangential + ", " + laws.rolling;
      check(plan, start, reference, name);
    }
  }
};

TEST_P(Kernels, GiveTheSameBits) {
  constexpr std::int64_t kSteps = 700;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 for (const SolverKind kind : {SolverKind::avx2, SolverKind::avx512, SolverKind::all_pairs})
                   if (available(kind)) {
                     EXPECT_TRUE(same_bits(reference, run(plan, start, kSteps, {.kind = kind})))
                         << make_solver(plan, {}, kind)->description() << ": " << name;
                   }
               });
  for (const auto& [kind, word] : {std::pair{SolverKind::avx2, "AVX2"}, {SolverKind::avx512, "AVX-512"}})
    if (!available(kind)) std::printf("not compared: this processor has no %s\n", word);
}

TEST_P(Kernels, RebuildIntervalDoesNotChangeBits) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(
      kSteps, [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
        const auto same = [&](const Habits& habits) {
          return same_bits(reference, run(plan, start, kSteps, habits));
        };
        EXPECT_TRUE(same({.kind = SolverKind::scalar, .rebuild_every = 1}))
            << name << ": lists built at every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .rebuild_every = 1}))
            << name << ": lists built at every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .rebuild_every = 7}))
            << name << ": lists built at every 7th step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .piece = 1})) << name << ": a call for every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .piece = 37})) << name << ": in pieces of 37 steps";
      });
}

// a stored vector changes sign when i and j are exchanged
TEST_P(Kernels, BeadOrderDoesNotChangeBits) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 std::vector<std::size_t> order(start.beads.size());
                 std::iota(order.begin(), order.end(), std::size_t{0});
                 std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
                 System shuffled = start;
                 for (std::size_t k = 0; k < order.size(); ++k) shuffled.beads[k] = start.beads[order[k]];
                 const Outcome outcome = run(plan, shuffled, kSteps, {.kind = SolverKind::best});
                 System back = outcome.system;
                 for (std::size_t k = 0; k < order.size(); ++k)
                   back.beads[order[k]] = outcome.system.beads[k];
                 EXPECT_TRUE(same_bits({back, reference.contacts}, reference)) << name;
               });
}

TEST_P(Kernels, ThreadCountDoesNotChangeBits) {
  constexpr std::int64_t kSteps = 40;
  for_each_law(
      kSteps, [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
        for (const int threads : {2, 3})
          EXPECT_TRUE(
              same_bits(reference, run(plan, start, kSteps, {.kind = SolverKind::best, .threads = threads})))
              << name << ": " << threads << " threads";
      });
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::ValuesIn(all_cases()), name_of_case);

}  // namespace
}  // namespace twincell::sim::kernels_test
