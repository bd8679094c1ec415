// Collected results of a sweep, written by hand in the format of `sweep collect`.
#include "twin/sweep_results.hpp"

#include <gtest/gtest.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell {
namespace {

std::string results(const std::string& plan) {
  return R"({"format": "twincell sweep 1", "plan": ")" + plan + R"(", "open": 0, "points": [
    {"id": "a", "axes": {"start.kind": "random", "drive.gamma": 1.5}, "results": {"phase": {"value": "bouncing"}}},
    {"id": "b", "axes": {"start.kind": "crystal_a", "drive.gamma": 2.5},
     "results": {"s_b": {"value": 0.5}, "s_c": {"value": 1.5}}},
    {"id": "d", "axes": {"start.kind": "crystal_a", "drive.gamma": 2.4}, "results": {"s_b": {"value": 0.5}}},
    {"id": "c", "axes": {"start.kind": "random", "drive.gamma": 9.0}, "failed": "an overlap"}],
   "onsets": [
    {"axes": {"start.kind": "random"}, "key": "drive.gamma", "verdict": "convecting", "value": 2.1, "low": 2.0,
     "high": 2.3, "range": [1, 3], "runs": 12, "yes": 5},
    {"axes": {"start.kind": "crystal_a"}, "key": "drive.gamma", "verdict": "convecting", "value": null, "low": 2.9,
     "high": null, "range": [1, 3], "runs": 9, "yes": 0}]})";
}

void check(const Comparison& c) {
  // The failed point has no phase, and neither has the bouncing one, which lacks s_c.
  ASSERT_EQ(c.sweep.size(), 2U);
  EXPECT_DOUBLE_EQ(c.sweep[0].n_l, 20);  // 400 beads in the preset's 20 sigma
  EXPECT_DOUBLE_EQ(c.sweep[0].gamma, 1.5);
  EXPECT_EQ(c.sweep[0].start, "random");
  EXPECT_EQ(c.sweep[1].phase, BedPhase::convecting);
  ASSERT_EQ(c.boundaries.size(), 2U);
  EXPECT_DOUBLE_EQ(c.boundaries[0].gamma().value(), 2.1);  // as fitted, not the middle of its interval
  EXPECT_NEAR(c.boundaries[0].half_width().value(), 0.15, 1e-12);
  EXPECT_EQ(c.boundaries[0].n_runs, 12U);
  EXPECT_EQ(boundary_of(c.boundaries[0]), "sweep, random");
  EXPECT_FALSE(c.boundaries[1].gamma());
  EXPECT_EQ(boundary_text(c.boundaries[1]), "above 2.9");
}

}  // namespace

TEST(SweepResults, PointsAndOnsetsArePlacedByTheirScene) {
  const TemporaryFolder folder;
  put_file(folder / "results.json",
           results(R"([scene]\npreset = 'fortini-huang-2015'\nbeads.count = 400\n)"));
  Comparison c;
  add_sweep(folder / "results.json", c);
  check(c);
}

// Beads of 2 mm: 800 of them in 80 mm are 20 layers. drive.peak_acceleration_g is another key for Gamma.
TEST(SweepResults, ASceneInLaboratoryUnitsIsPlacedByThem) {
  const TemporaryFolder folder;
  std::string text = results(
      R"([scene]\npreset = 'fortini-huang-2015'\nbeads.count = 800\ncell.width_mm = 80.0\nscale.sigma_mm = 2\nscale.gravity_m_s2 = 9.81\n)");
  const std::string gamma = "drive.gamma";
  for (std::size_t at = text.find(gamma); at != std::string::npos; at = text.find(gamma, at))
    text.replace(at, gamma.size(), "drive.peak_acceleration_g");
  put_file(folder / "results.json", text);
  Comparison c;
  add_sweep(folder / "results.json", c);
  check(c);
}

TEST(SweepResults, TheSceneMayStandBesideThePlan) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "plan.sweep");
  put_file(folder / "plan.sweep/results.json", results(R"(scene = 'base.toml'\n)"));
  Comparison c;
  EXPECT_THROW(add_sweep(folder / "plan.sweep/results.json", c), InputError);
  put_file(folder / "base.toml", "preset = 'fortini-huang-2015'\n[beads]\ncount = 400\n");
  add_sweep(folder / "plan.sweep/results.json", c);
  check(c);
}

TEST(SweepResults, AnythingElseIsRefused) {
  const TemporaryFolder folder;
  Comparison c;
  for (const char* text :
       {"", "[]", "{\"format\": \"else\"}", "{\"format\": \"twincell sweep 1\"}",
        // A key of a point or an onset is missing or has another type.
        R"({"format": "twincell sweep 1", "plan": 3, "points": []})",
        R"({"format": "twincell sweep 1", "plan": "[scene]\ndrive.gamma = 1.0"})",
        R"({"format": "twincell sweep 1", "plan": "[scene]\ndrive.gamma = 1.0", "points":
                               [{"results": {"phase": {"value": "bouncing"}}}]})",
        R"({"format": "twincell sweep 1", "plan": "[scene]\ndrive.gamma = 1.0", "points": [],
                               "onsets": [{"verdict": "bouncing", "key": "drive.gamma"}]})"}) {
    put_file(folder / "results.json", text);
    EXPECT_THROW(add_sweep(folder / "results.json", c), InputError) << text;
  }
}

}  // namespace twincell
