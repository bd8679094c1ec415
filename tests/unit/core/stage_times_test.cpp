// Stages that begin inside one another, against a clock that the test sets.
#include "core/stage_times.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace twincell::stage_times_test {
namespace {

double now = 0;
double fake_clock() {
  return now;
}

struct StageTimesTest : ::testing::Test {
  StageTimesTest() { now = 100; }
};

TEST_F(StageTimesTest, EveryInstantBelongsToOneStage) {
  StageTimes times(&fake_clock);
  now += 1;  // other
  {
    Stage stepping(&times, "stepping", "steps");
    now += 10;
    {
      Stage writing(&times, "writing", "frames");
      now += 4;
      writing.count(2, 80);
    }
    now += 20;
    stepping.count(60);
  }
  now += 2;  // other
  {
    Stage stepping(&times, "stepping", "ignored: the unit is that of the first entry");
    now += 30;
    stepping.count(60);
  }
  now += 5;  // other, not ended by a stage
  const std::vector<StageTimes::Row> rows = times.rows();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].name, "stepping");
  EXPECT_EQ(rows[0].unit, "steps");
  EXPECT_EQ(rows[0].seconds, 60);
  EXPECT_EQ(rows[0].count, 120);
  EXPECT_EQ(rows[0].per_second(), 2);
  EXPECT_EQ(rows[1].name, "writing");
  EXPECT_EQ(rows[1].seconds, 4);
  EXPECT_EQ(rows[1].per_second(), 0.5);
  EXPECT_EQ(rows[1].bytes_per_second(), 20);
  EXPECT_EQ(rows[2].name, "other");
  EXPECT_EQ(rows[2].seconds, 8);
  EXPECT_EQ(rows[0].seconds + rows[1].seconds + rows[2].seconds, now - 100);
}

TEST_F(StageTimesTest, AnErrorEndsItsStages) {
  StageTimes times(&fake_clock);
  try {
    const Stage outer(&times, "outer");
    const Stage inner(&times, "inner");
    now += 1;
    throw std::runtime_error("");
  } catch (const std::runtime_error&) {
  }
  now += 7;
  EXPECT_EQ(times.rows().back().name, "other");
  EXPECT_EQ(times.rows().back().seconds, 7);
}

TEST_F(StageTimesTest, RowsIncludeTheStageThatRuns) {
  StageTimes times(&fake_clock);
  const Stage stage(&times, "running");
  now += 3;
  EXPECT_EQ(times.rows().front().seconds, 3);
  now += 2;
  EXPECT_EQ(times.rows().front().seconds, 5);
  EXPECT_EQ(times.rows().front().per_second(), 0) << "nothing was counted";
}

TEST_F(StageTimesTest, RowsOfThreadsAddUpByName) {
  using Row = StageTimes::Row;
  std::vector<Row> sum;
  StageTimes::add({{"stepping", "steps", 3, 30, 300}, {"other", "", 1, 0, 0}}, sum);
  StageTimes::add({{"writing", "frames", 2, 4, 5}, {"stepping", "steps", 1, 10, 100}, {"other", "", 6, 0, 0}},
                  sum);
  ASSERT_EQ(sum.size(), 3U);
  EXPECT_EQ(sum[0].name, "stepping");
  EXPECT_EQ(sum[0].seconds, 4);
  EXPECT_EQ(sum[0].count, 40);
  EXPECT_EQ(sum[0].bytes, 400);
  EXPECT_EQ(sum[0].bytes_per_second(), 100);
  EXPECT_EQ(sum[1].name, "writing");
  EXPECT_EQ(sum[1].unit, "frames");
  EXPECT_EQ(sum[2].name, "other");
  EXPECT_EQ(sum[2].seconds, 7);
}

TEST_F(StageTimesTest, WithoutTimesNothingIsTimed) {
  Stage stage(nullptr, "any", "pieces");
  stage.count(1);
  EXPECT_EQ(now, 100);
}

TEST(StageTimes, TheClockNeverGoesBack) {
  const double before = StageTimes::elapsed_seconds();
  EXPECT_LE(before, StageTimes::elapsed_seconds());
}

}  // namespace
}  // namespace twincell::stage_times_test
