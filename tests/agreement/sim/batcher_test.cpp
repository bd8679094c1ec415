// Many beds that share launches: each has the bits of a bed that runs alone, and none depends on the others.

#include "sim/device/batcher.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "core/error.hpp"
#include "sim/device/device_solver.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "tests/support/dense_bed.hpp"

namespace twincell::sim::batcher_test {
namespace {

constexpr std::size_t kBeds = 50;
constexpr std::int64_t kSteps = 200;
const GuardLimits kLimits{.overlap = 0.3, .travel_per_step = 1};

/// The host executor, with something to do before each launch.
class Watched : public Executor {
 public:
  using Before = std::function<void(std::size_t beds)>;
  explicit Watched(Before before) : before_(std::move(before)) {}
  [[nodiscard]] std::byte* allocate(std::size_t bytes) override { return host_->allocate(bytes); }
  void release(std::byte* memory) override { host_->release(memory); }
  void write(std::byte* to, const void* from, std::size_t n) override { host_->write(to, from, n); }
  void read(void* to, const std::byte* from, std::size_t n) override { host_->read(to, from, n); }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    before_(beds.size());
    host_->advance(kernel, beds);
  }
  [[nodiscard]] std::string description() const override { return host_->description(); }

 private:
  std::unique_ptr<Executor> host_ = make_host_executor();
  Before before_;
};

struct Bed {
  Plan plan;
  System system;
};
/// Beds that differ in their velocities. \param laws of bed k
std::vector<Bed> some_beds(const std::function<LawWords(std::size_t k)>& laws) {
  std::vector<Bed> beds;
  for (std::size_t k = 0; k < kBeds; ++k) {
    const Scene scene =
        scene_of({.dimension = 2, .integrator = "split", .unequal = false, .periodic = false}, laws(k));
    Bed bed{make_plan(scene), {}};
    bed.system = bed_of(scene, bed.plan);
    bed.system.beads[0].vx += 0.01 * static_cast<double>(k);
    beds.push_back(std::move(bed));
  }
  return beds;
}
LawWords springs(std::size_t /*k*/) {
  return {"linear", "spring", "none"};
}

/// Advances every bed in a thread of its own. \returns the sentence of each that failed
std::vector<std::string> together(std::vector<Bed>& beds, Batcher& batcher) {
  std::vector<std::string> failures(beds.size());
  std::vector<std::thread> threads;
  threads.reserve(beds.size());
  for (std::size_t k = 0; k < beds.size(); ++k)
    threads.emplace_back([&, k] {
      try {
        make_device_solver(beds[k].plan, kLimits, batcher)->advance(beds[k].system, kSteps);
      } catch (const Error& e) {
        failures[k] = e.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
  return failures;
}

void expect_as_alone(const std::vector<Bed>& ran, std::vector<Bed> starts, std::size_t except = kBeds) {
  for (std::size_t k = 0; k < kBeds; ++k) {
    if (k == except) continue;
    Batcher own(make_host_executor());
    make_device_solver(starts[k].plan, kLimits, own)->advance(starts[k].system, kSteps);
    EXPECT_TRUE(same_bits({ran[k].system, {}}, {starts[k].system, {}})) << "bed " << k;
  }
}

TEST(Batcher, BedsThatArriveDuringALaunchShareTheNext) {
  std::vector<std::size_t> sizes;
  Batcher* of_all = nullptr;
  Batcher batcher(std::make_unique<Watched>([&](std::size_t beds) {
    if (sizes.empty())  // the first launch lasts until all others wait
      while (of_all->waiting() < kBeds - 1) std::this_thread::yield();
    sizes.push_back(beds);
  }));
  of_all = &batcher;
  std::vector<Bed> beds = some_beds(springs);
  const std::vector<Bed> starts = beds;
  for (const std::string& failure : together(beds, batcher)) EXPECT_EQ(failure, "");
  EXPECT_EQ(sizes, (std::vector<std::size_t>{1, kBeds - 1}));
  expect_as_alone(beds, starts);
}

TEST(Batcher, BedsOfSeveralLawsRunTogether) {
  Batcher batcher(make_host_executor());
  std::vector<Bed> beds = some_beds([](std::size_t k) {
    return k % 3 == 0   ? LawWords{"hertz", "mindlin", "none"}
           : k % 3 == 1 ? LawWords{"linear", "dashpot", "none"}
                        : LawWords{"linear", "spring", "none"};
  });
  const std::vector<Bed> starts = beds;
  for (const std::string& failure : together(beds, batcher)) EXPECT_EQ(failure, "");
  expect_as_alone(beds, starts);
}

TEST(Batcher, ABedThatFailsStopsNoOther) {
  constexpr std::size_t kBad = 17;
  Batcher batcher(make_host_executor());
  std::vector<Bed> beds = some_beds(springs);
  // A bead that meets the next at a speed that its springs do not bear.
  beds[kBad].system.beads[3].vz = -60;
  const std::vector<Bed> starts = beds;
  const std::vector<std::string> failures = together(beds, batcher);
  for (std::size_t k = 0; k < kBeds; ++k)
    if (k != kBad) {
      EXPECT_EQ(failures[k], "");
    }
  expect_as_alone(beds, starts, kBad);

  // The sentence is that of the oracle, at the same step.
  System by_oracle = starts[kBad].system;
  try {
    make_solver(starts[kBad].plan, kLimits, SolverKind::all_pairs)->advance(by_oracle, kSteps);
    ADD_FAILURE() << "the oracle bears the speed";
  } catch (const RunError& e) {
    EXPECT_NE(failures[kBad].find("overlap by"), std::string::npos) << failures[kBad];
    EXPECT_EQ(failures[kBad], e.what());
  }
}

TEST(Batcher, AnErrorOfTheMachineReachesEveryBed) {
  Batcher batcher(std::make_unique<Watched>([](std::size_t) { throw Error(ExitCode::failed, "no power"); }));
  std::vector<Bed> beds = some_beds(springs);
  for (const std::string& failure : together(beds, batcher)) EXPECT_EQ(failure, "no power.");
}

TEST(DeviceSolver, WhatHasNoKernelIsRefusedByName) {
  Batcher batcher(make_host_executor());
  const auto refusal = [&](const LawWords& laws) -> std::string {
    const Scene scene =
        scene_of({.dimension = 2, .integrator = "split", .unequal = false, .periodic = false}, laws);
    try {
      (void)make_device_solver(make_plan(scene), kLimits, batcher);
      return "";
    } catch (const ConfigError& e) {
      return e.what();
    }
  };
  EXPECT_EQ(refusal({"linear", "spring", "none"}), "");
  EXPECT_NE(refusal({"cohesive", "spring", "none"}).find("no kernel for 2D; normal: linear spring"),
            std::string::npos)
      << refusal({"cohesive", "spring", "none"});
  EXPECT_NE(refusal({"linear", "spring", "spring"}).find("all without rolling resistance"),
            std::string::npos);
}

}  // namespace
}  // namespace twincell::sim::batcher_test
