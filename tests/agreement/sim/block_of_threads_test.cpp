// The device kernel with real threads that wait for each other at barriers, as the threads of a block do:
// every thread passes the same barriers, and no thread reads what another has not finished.

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <cstring>
#include <thread>

#include "sim/device/advance_bed.hpp"
#include "sim/device/device_solver.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "tests/support/dense_bed.hpp"

namespace twincell::sim::block_of_threads_test {
namespace {

constexpr std::int32_t kThreads = 3;  // no divisor of the number of beads

/// One thread of a block.
struct ThreadSpace {
  std::int32_t thread;
  std::barrier<>* barrier;
  std::atomic<bool>* found;
  std::atomic<std::int32_t>*front, *back;

  template <class F>
  void for_each(std::int32_t count, F f) const {
    for (std::int32_t i = thread; i < count; i += kThreads) f(i);
    barrier->arrive_and_wait();
  }
  template <class F>
  bool any(std::int32_t count, F f) const {
    for (std::int32_t i = thread; i < count; i += kThreads)
      if (f(i)) *found = true;
    barrier->arrive_and_wait();
    const bool answer = *found;
    barrier->arrive_and_wait();
    if (thread == 0) *found = false;
    barrier->arrive_and_wait();
    return answer;
  }
  template <class F>
  SortedCounts sort(std::int32_t count, std::int32_t* list, F f) const {
    for_each(count, [&](std::int32_t i) {
      const Sorted to = f(i);
      if (to == Sorted::front) list[(*front)++] = i;
      if (to == Sorted::back) list[count - 1 - (*back)++] = i;
    });
    const SortedCounts n{*front, *back};
    barrier->arrive_and_wait();
    if (thread == 0) *front = *back = 0;
    barrier->arrive_and_wait();
    return n;
  }
  template <class F>
  void once(F f) const {
    if (thread == 0) f();
    barrier->arrive_and_wait();
  }
};

/// Runs the kernel of one set of laws on a block of threads.
class BlockExecutor : public Executor {
 public:
  using Laws = LawSet<LinearSpringDashpot, SpringSlider, NoRolling>;
  [[nodiscard]] std::byte* allocate(std::size_t bytes) override { return host_->allocate(bytes); }
  void release(std::byte* memory) override { host_->release(memory); }
  void write(std::byte* to, const void* from, std::size_t n) override { host_->write(to, from, n); }
  void read(void* to, const std::byte* from, std::size_t n) override { host_->read(to, from, n); }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    ASSERT_EQ(kernel.name, "linear_spring_2d_full");
    for (const DeviceBed& bed : beds) {
      std::barrier<> barrier(kThreads);
      std::atomic<bool> found = false;
      std::atomic<std::int32_t> front = 0, back = 0;
      std::vector<std::thread> block;
      for (std::int32_t t = 0; t < kThreads; ++t)
        block.emplace_back([&, t] {
          advance_bed<ThreadSpace, Laws, 2, Velocity::full_step>(
              ThreadSpace{t, &barrier, &found, &front, &back}, bed);
        });
      for (std::thread& thread : block) thread.join();
    }
  }
  [[nodiscard]] std::string description() const override { return "a block of threads"; }

 private:
  std::unique_ptr<Executor> host_ = make_host_executor();
};

TEST(BlockOfThreads, HasTheBitsOfTheOracle) {
  constexpr GuardLimits kLimits{.overlap = 0.3, .travel_per_step = 1};
  constexpr std::int64_t kSteps = 300;
  for (const bool unequal : {false, true}) {
    const Scene scene =
        scene_of({.dimension = 2, .integrator = "split", .unequal = unequal, .periodic = true},
                 {"linear", "spring", "none"});
    const Plan plan = make_plan(scene);
    Outcome reference{bed_of(scene, plan), {}}, outcome{bed_of(scene, plan), {}};
    const auto oracle = make_solver(plan, kLimits, SolverKind::all_pairs);
    oracle->advance(reference.system, kSteps);
    reference.contacts = oracle->contacts();
    Batcher batcher(std::make_unique<BlockExecutor>());
    const auto solver = make_device_solver(plan, kLimits, batcher);
    for (int call = 0; call < 3; ++call) solver->advance(outcome.system, kSteps / 3);
    outcome.contacts = solver->contacts();
    EXPECT_TRUE(same_bits(reference, outcome)) << (unequal ? "unequal" : "equal") << " beads";
    EXPECT_GT(solver->list_builds(), 1);
  }
}

}  // namespace
}  // namespace twincell::sim::block_of_threads_test
