// For every result that has an interval, in beds of several kinds: the interval contains the value and has a
// width. Every result without an interval states the reason. Coverage is tested for each observable in
// coverage_test.cpp (docs/validation.md, V5.12).

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "analysis/observable/observable.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::analysis::intervals_test {
namespace {

std::vector<Result> results_of(const std::string& scene, const AnalysisOptions& options) {
  sim::Simulation run(sim::read_scene_text(scene, "bed"));
  MemoryTrajectory out(run.trajectory_info());
  run.run(out);
  return analyze(out, options);
}

/// Names of the results that have an interval.
std::set<std::string> hold(const std::string& what, const std::vector<Result>& results) {
  std::set<std::string> with;
  for (const Result& r : results) {
    if (!r.present() || !r.text.empty() || r.values.size() != 1) continue;
    const std::string of = what + ": " + r.name;
    if (!r.interval) {
      EXPECT_FALSE(r.no_interval.empty()) << of << " has no interval and does not say why";
      continue;
    }
    with.insert(r.name);
    EXPECT_TRUE(std::isfinite(r.value())) << of;
    EXPECT_LE(r.interval->low, r.value()) << of;
    EXPECT_GE(r.interval->high, r.value()) << of;
    EXPECT_GT(r.interval->high, r.interval->low) << of << " = " << r.value() << ", an interval without width";
    const Range range = named_result(r.name).range;
    EXPECT_TRUE(range == Range::any || r.interval->low >= 0) << of << " from " << r.interval->low;
    EXPECT_TRUE(range != Range::share || r.interval->high <= 1) << of << " to " << r.interval->high;
  }
  return with;
}

const std::string kTime = "[time]\ndiscard = 3\nsteps_per_contact = 12\nintegrator = \"split\"\n";

TEST(Intervals, HoldTheirValueAndHaveAWidth) {
  const std::vector<std::pair<std::string, std::string>> beds = {
      {"random bed that bounces",
       "preset = \"fortini-huang-2015\"\nbeads.layers = 6\ncell.width = 10\n[drive]\ngamma = 1.4\n"
       "[start]\nkind = \"random\"\n" +
           kTime + "cycles = 60\n"},
      {"random bed that convects",
       "preset = \"fortini-huang-2015\"\nbeads.layers = 16\ncell.width = 10\n[drive]\ngamma = 3\n"
       "[start]\nkind = \"random\"\n" +
           kTime + "cycles = 60\n"},
      {"crystal at rest on the plate",
       "preset = \"fortini-huang-2015\"\nbeads.layers = 5\ncell.width = 8\n[drive]\ngamma = 0.8\n"
       "[start]\nperturbation = 1e-9\n" +
           kTime + "cycles = 40\n"},
      {"crystal that bounces",
       "preset = \"fortini-huang-2015\"\nbeads.layers = 5\ncell.width = 8\n[drive]\ngamma = 2\n"
       "[start]\nperturbation = 1e-9\n" +
           kTime + "cycles = 40\n"},
      {"gas", "preset = \"bhateja-2016-smooth-2d\"\n[drive]\nk_m = 20\n[time]\ndiscard = 5\ncycles = 150\n"},
      {"three cycles",
       "preset = \"fortini-huang-2015\"\nbeads.layers = 4\ncell.width = 8\n[drive]\ngamma = 2\n" + kTime +
           "cycles = 3\n"}};
  std::set<std::string> seen;
  for (const auto& [what, scene] : beds)
    for (const SbForm form : {SbForm::variance, SbForm::about_rest}) {
      AnalysisOptions options;
      options.s_b = form;
      options.rest_height = 2.5;
      seen.merge(hold(what, results_of(scene, options)));
    }
  // Guards against an empty test: these results must have had an interval.
  for (const char* name : {"s_b", "s_c", "T_g", "p_s", "h_cm", "T_g_aliasing"})
    EXPECT_TRUE(seen.contains(name)) << name;
  EXPECT_GE(seen.size(), 15U);
}

}  // namespace
}  // namespace twincell::analysis::intervals_test
