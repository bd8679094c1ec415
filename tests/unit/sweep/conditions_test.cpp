// N_l, Gamma and start are stored with every point of a sweep, and collected from there.
#include "sweep/conditions.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_view.hpp"
#include "sweep/collect.hpp"
#include "sweep/plan.hpp"
#include "sweep/point_run.hpp"
#include "sweep/schedule.hpp"
#include "sweep/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sweep::conditions_test {
namespace {

using nlohmann::json;

/// Beads of 2 mm in a cell of 8 mm: 12 of them are N_l sigma = 12/4 = 3. Gamma = 1.5 in units of g.
constexpr const char* kPlan = R"(
[scene]
preset = "fortini-huang-2015"
beads.count = 12
cell.width_mm = 8.0
scale.sigma_mm = 2
scale.gravity_m_s2 = 9.81
time.discard = 0
time.cycles = 1
drive.omega_per_t0 = 1.0
[axes]
drive.peak_acceleration_g = [1.5]
start.kind = ["crystal_a"]
)";

/// The collected document of a sweep whose only point has this result.
json collected(const Plan& plan, const Point& point, const std::string& result) {
  const TemporaryFolder folder;
  const Store store(folder / "sweep");
  {
    const auto claim = store.claim(point);
    store.keep(point, result);
  }
  return json::parse(collected_json(Schedule(plan, store)));
}

TEST(SweepConditions, ARunStoresWhereItStands) {
  const Plan plan = read_plan_text(kPlan, "plan.toml");
  const Point point = make_point(plan, combinations(plan.axes).front(), {}, 0);
  const std::string result = run_point(plan, point, {}, Progress::none());
  const RunConditions at = conditions_from_json(JsonView::parse(result, "result").at("conditions"));
  EXPECT_DOUBLE_EQ(at.n_l.value(), 3);
  EXPECT_DOUBLE_EQ(at.gamma.value(), 1.5);
  EXPECT_EQ(at.start, "crystal_a");
  EXPECT_EQ(collected(plan, point, result)["points"][0]["conditions"], json::parse(result).at("conditions"));
}

// A result of an earlier version has no conditions; the scene of its point gives them.
TEST(SweepConditions, AnEarlierResultIsCompletedFromItsScene) {
  const Plan plan = read_plan_text(kPlan, "plan.toml");
  const Point point = make_point(plan, combinations(plan.axes).front(), {}, 0);
  const std::string earlier =
      json{{"id", point.id}, {"results", json::object()}, {"computed", json::object()}}.dump();
  const json conditions = collected(plan, point, earlier)["points"][0]["conditions"];
  EXPECT_DOUBLE_EQ(conditions["n_l"].get<double>(), 3);
  EXPECT_DOUBLE_EQ(conditions["gamma"].get<double>(), 1.5);
  EXPECT_EQ(conditions["start"], "crystal_a");
}

TEST(SweepConditions, AbsentNumbersAreNull) {
  const json absent = conditions_json({.n_l = {}, .gamma = {}, .start = "table"});
  EXPECT_TRUE(absent["n_l"].is_null() && absent["gamma"].is_null());
  const RunConditions back = conditions_from_json(JsonView::parse(absent.dump(), "absent"));
  EXPECT_FALSE(back.n_l || back.gamma);
  EXPECT_EQ(back.start, "table");
  EXPECT_THROW((void)conditions_from_json(JsonView::parse(R"({"n_l": 1})", "partial")), InputError);
}

}  // namespace
}  // namespace twincell::sweep::conditions_test
