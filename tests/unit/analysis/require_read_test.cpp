// An option on which no requested result depends is refused, and no other.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "analysis/observable/observable.hpp"
#include "core/error.hpp"
#include "tests/support/complaint.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis::require_read_test {
namespace {

/// A bed with a lattice, defects and free places, shaken so that beads move and exchange neighbours.
MemoryTrajectory bed() {
  constexpr int kCycles = 6, kPhases = 4, kColumns = 12, kRows = 8;
  TrajectoryInfo info;
  info.n_beads = kColumns * kRows;
  info.columns.velocity = info.columns.phase = true;
  info.phases_per_cycle = kPhases;
  info.box.dimension = 2;
  info.box.upper = Vec3(kColumns + 1, 1, 40);
  info.drive = Drive{.amplitude = 2, .omega = 1};
  MemoryTrajectory trajectory(info);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 0.25);
  for (int f = 0; f < kCycles * kPhases; ++f) {
    Frame frame;
    frame.cycle = f / kPhases;
    frame.phase = f % kPhases;
    frame.time = 2 * std::numbers::pi * f / kPhases;
    for (int i = 0; i < kColumns * kRows; ++i) {
      const int row = i / kColumns;
      const double lift = f == 0 ? 0 : 0.2 * row * (1 + std::sin(frame.time));
      frame.position.emplace_back(i % kColumns + 0.75 + 0.5 * (row % 2) + noise(random), 0,
                                  0.5 + row * std::sqrt(0.75) + lift + (f == 0 ? 0 : noise(random)));
      frame.velocity.emplace_back(noise(random), 0, noise(random));
    }
    trajectory.append(frame);
  }
  return trajectory;
}

std::map<std::string, AnalysisOptions> changes() {
  std::map<std::string, AnalysisOptions> all;
  all["tracers"].tracers = {3, 40};
  all["tracer band"].tracer_band = {2.0, 4.0};
  all["s_b"].s_b = SbForm::as_printed;
  all["neighbours"].neighbours = NeighbourRule::delaunay;
  all["cutoff"].neighbour_cutoff = 1.5;
  all["cell radius"].cell_radius = 0.8;
  all["field cell"].field_cell = 4;
  all["rest height"].rest_height = 3.5;
  return all;
}

bool accepted(AnalysisOptions options, const std::string& name) {
  options.only = {name};
  try {
    require_read(options);
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

TEST(RequireRead, WhatIsRefusedChangesNothing) {
  const MemoryTrajectory trajectory = bed();
  const std::vector<Result> plain = analyze(trajectory);
  for (const auto& [what, options] : changes()) {
    const std::vector<Result> changed = analyze(trajectory, options);
    ASSERT_EQ(changed.size(), plain.size());
    std::size_t refused = 0, differ = 0;
    for (std::size_t k = 0; k < plain.size(); ++k) {
      const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
      const Result &a = plain[k], &b = changed[k];
      ASSERT_EQ(a.name, b.name);
      const bool equal = a.text == b.text && a.absent == b.absent &&
                         std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(), same);
      const bool accepts = accepted(options, a.name);
      EXPECT_TRUE(equal || accepts) << what << " changes " << a.name << ", but is refused";
      refused += accepts ? 0 : 1;
      differ += equal ? 0 : 1;
    }
    EXPECT_GT(differ, 0U) << what << " changes no result of this bed";
    EXPECT_GT(refused, plain.size() / 2) << what;
  }
}

TEST(RequireRead, TheRefusalNamesWhatDepends) {
  const std::string said = complaint_of([] { require_read({.s_b = SbForm::as_printed, .only = {"q6"}}); });
  EXPECT_NE(said.find("s_b"), std::string::npos) << said;
  EXPECT_NE(said.find("no requested result depends on it; s_k, s_b,"), std::string::npos) << said;
  EXPECT_NO_THROW(require_read({.s_b = SbForm::as_printed}));
  EXPECT_NO_THROW(require_read({.s_b = SbForm::as_printed, .only = {"q6", "s_b"}}));
  // The cutoff belongs to one rule for neighbours, the radius of the cells to the others.
  EXPECT_NO_THROW(require_read({.neighbour_cutoff = 1.3, .only = {"q6"}}));
  EXPECT_THROW(require_read({.neighbours = NeighbourRule::delaunay, .neighbour_cutoff = 1.3}), ConfigError);
  EXPECT_THROW(require_read({.cell_radius = 0.8, .only = {"q6"}}), ConfigError);
  EXPECT_NO_THROW(require_read({.neighbours = NeighbourRule::delaunay, .cell_radius = 0.8, .only = {"q6"}}));
}

}  // namespace
}  // namespace twincell::analysis::require_read_test
