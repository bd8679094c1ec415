// The time limit of a sweep on this machine.

#include "sweep/farm.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "sweep/plan.hpp"
#include "sweep/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sweep::farm_test {
namespace {

using Clock = std::chrono::steady_clock;

class Limited : public Watch {
 public:
  explicit Limited(double seconds) : seconds_(seconds) {}
  [[nodiscard]] double time_left() const override { return seconds_ - elapsed(); }
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  void cost(double seconds) override { processor_seconds = seconds; }
  double processor_seconds = 0;

 private:
  double seconds_;
  Clock::time_point begin_ = Clock::now();
};

/// \param cycles of each point: "2, 3"
Plan plan_of(const std::string& cycles) {
  return read_plan_text(
      "seed = 1\nresults = [\"s_b\"]\n[scene]\npreset = \"fortini-huang-2015\"\nbeads.layers = 4\ncell.width "
      "= "
      "6.0\ndrive.gamma = 1.6\ntime.discard = 0\ntime.steps_per_contact = 6.37\n[axes]\ntime.cycles = [" +
          cycles + "]\n",
      "plan");
}

/// An empty store.
class Farm : public ::testing::Test {
 protected:
  const TemporaryFolder folder_;
  const Store store_{folder_ / "runs"};
};

// The first points are begun without knowing their time.
TEST_F(Farm, PointsThatAreLateAreEndedAndStayOpen) {
  const Plan plan = plan_of("2, 1000000, 2000000");  // of which two take hours
  Schedule schedule(plan, store_);
  Limited watch(0.2);
  EXPECT_FALSE(run_here({&schedule}, store_, {.threads = 3}, watch));
  EXPECT_GT(watch.elapsed(), 5.0);
  EXPECT_LT(watch.elapsed(), 15.0);
  Schedule again(plan, store_);
  EXPECT_EQ(again.counts().done, 1U);
  EXPECT_EQ(again.counts().known, 3U);
  EXPECT_TRUE(again.take(1e300)) << "the right to compute the point was not given back";
}

TEST_F(Farm, PointsInTimeAreDone) {
  const Plan plan = plan_of("2, 3, 4");
  Schedule schedule(plan, store_);
  Limited watch(60);
  EXPECT_TRUE(run_here({&schedule}, store_, {.threads = 2}, watch));
  EXPECT_EQ(schedule.counts().done, 3U);
}

// What a figure cost stands in its runs, so that a call that was killed, or that continued another one, does
// not change it.
TEST_F(Farm, CostIsTheProcessorTimeOfAllResults) {
  const Plan one = plan_of("2"), three = plan_of("2, 3, 4");
  Schedule first(one, store_);
  Limited watch(60);
  run_here({&first}, store_, {.threads = 1}, watch);
  EXPECT_GT(watch.processor_seconds, 0);
  EXPECT_LT(watch.processor_seconds, 60);
  Schedule all(three, store_);
  Limited second(60);
  run_here({&all}, store_, {.threads = 2}, second);
  double sum = 0;
  for (const Curve& curve : all.curves())
    for (const auto& result : curve.results)
      sum += nlohmann::json::parse(*result)["computed"]["processor_seconds"].get<double>();
  EXPECT_NEAR(second.processor_seconds, sum, 1e-9);
  EXPECT_GT(sum, watch.processor_seconds) << "the result of the first call is missing";
}

TEST_F(Farm, CostIsUnknownWhereAResultDoesNotStateIt) {
  const Plan plan = plan_of("2");
  Schedule schedule(plan, store_);
  Limited watch(60);
  run_here({&schedule}, store_, {.threads = 1}, watch);
  const auto file = store_.folder() / "points" / schedule.curves().front().points.front().id / "result.json";
  nlohmann::json result = nlohmann::json::parse(read_text_file(file));
  result["computed"].erase("processor_seconds");
  std::ofstream(file) << result.dump() << "\n";
  Schedule again(plan, store_);
  EXPECT_TRUE(run_here({&again}, store_, {.threads = 1}, watch));
  EXPECT_TRUE(std::isnan(watch.processor_seconds));
}

}  // namespace
}  // namespace twincell::sweep::farm_test
