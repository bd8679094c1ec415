// What a sweep may still cost, as it is known before its first point.

#include <gtest/gtest.h>

#include <cmath>

#include "sweep/farm.hpp"
#include "sweep/plan.hpp"
#include "sweep/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sweep::budget_test {
namespace {

constexpr double kBeads = 24;

/// A bed of 24 beads, 6 wide. \param rest axes or search
Plan plan_of(const std::string& cycles, const std::string& rest) {
  return read_plan_text(
      "seed = 1\nresults = [\"s_b\"]\n[scene]\npreset = \"fortini-huang-2015\"\nbeads.layers = 4\n"
      "cell.width = 6.0\nstart.kind = \"random\"\ntime.discard = 0\ntime.steps_per_contact = 6.37\n"
      "time.cycles = " +
          cycles + "\n" + rest,
      "plan");
}

const std::string kSearch =
    "[search]\nverdict = \"bouncing\"\nrange = [1.0, 1.5]\nwidth = 0.01\nruns = 20\nbatch = 2\n";
const std::string kGrid = "[axes]\ndrive.gamma = [1.2, 1.4, 1.6]\nseeds = 2\n";

struct Expected : Watch {
  void expect(const Counts& c, double s) override {
    counts = c;
    seconds = s;
    ++calls;
  }
  Counts counts;
  double seconds = 0;
  int calls = 0;
};

TEST(Budget, ASearchMayNeedAllOfItsRuns) {
  const TemporaryFolder folder;
  const Store store(folder / "runs");
  const Plan plan = plan_of("100", kSearch);
  const Schedule schedule(plan, store);
  const Counts counts = schedule.counts();
  EXPECT_EQ(counts.known, 2U);
  EXPECT_EQ(counts.most, 20U);
  EXPECT_NEAR(counts.most_work, 10 * counts.work_left, 1e-9 * counts.most_work);
  ASSERT_NE(schedule.longest_open(), nullptr);
  EXPECT_NEAR(schedule.longest_open()->work, counts.work_left / 2, 1e-9 * counts.work_left);
}

TEST(Budget, AGridNeedsWhatIsKnown) {
  const TemporaryFolder folder;
  const Store store(folder / "runs");
  const Plan plan = plan_of("100", kGrid);
  const Counts counts = Schedule(plan, store).counts();
  EXPECT_EQ(counts.most, 6U);
  EXPECT_EQ(counts.most, counts.known);
  EXPECT_EQ(counts.most_work, counts.work_left);
}

// At most 10^9 and at least 10^6 particle-steps a second and core: the time is that of this machine.
TEST(Budget, IsAnnouncedIfItIsMinutes) {
  const TemporaryFolder folder;
  const Store store(folder / "runs");
  const Plan minutes = plan_of("100000", kSearch), moments = plan_of("10", kSearch);
  Schedule long_one(minutes, store), short_one(moments, store);
  Expected none, two;
  announce({&short_one}, {.threads = 1}, none);
  EXPECT_EQ(none.calls, 0);
  announce({&long_one, &short_one}, {.threads = 2}, two);
  ASSERT_EQ(two.calls, 1);
  EXPECT_EQ(two.counts.most, 40U);
  EXPECT_GT(two.counts.most_work, 20 * kBeads * 1e5 * 1000);
  EXPECT_GT(two.seconds, two.counts.most_work / 2 / 1e9);
  EXPECT_LT(two.seconds, two.counts.most_work / 2 / 1e6);
}

}  // namespace
}  // namespace twincell::sweep::budget_test
