#include "analysis/runs/windows.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <sstream>

#include "analysis/report/windows_figure.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::analysis::windows_test {
namespace {

constexpr int kPhases = 4;

/// Beads at rest at the height 1 + cycle/10 above the plate of a drive whose Gamma goes from 1 to 2 in 10
/// cycles after 3 that are not recorded.
MemoryTrajectory ramped_run() {
  TrajectoryInfo info;
  info.n_beads = 3;
  info.columns = {.velocity = true, .phase = true, .plate_height = true};
  info.box.upper = Vec3(3, 1, 10);
  info.phases_per_cycle = kPhases;
  info.source = Origin::simulation;
  Drive drive{.amplitude = 1, .omega = 1};
  drive.ramp = DriveRamp{.from = {1, 1}, .to = {2, 1}, .power = 2, .first = 3, .cycles = 10};
  info.drive = drive;
  MemoryTrajectory run(info);
  for (int k = 0; k < 10 * kPhases; ++k) {
    Frame f;
    f.cycle = k / kPhases, f.phase = k % kPhases, f.step = k;
    const double fraction = static_cast<double>(f.phase) / kPhases;
    f.time = drive.time_at(3 + static_cast<double>(f.cycle) + fraction);
    f.plate_height = drive.displacement(fraction, 3 + f.cycle);
    for (int i = 0; i < 3; ++i) {
      f.position.emplace_back(0.5 + i, 0.5, 1 + 0.1 * static_cast<double>(f.cycle));
      f.velocity.emplace_back(0, 0, 0);
    }
    run.append(f);
  }
  return run;
}

TEST(Windows, EachHasItsDriveAndItsResults) {
  const MemoryTrajectory run = ramped_run();
  const std::vector<Window> windows = analyze_windows(run, {.only = {"h_cm"}}, 3);
  ASSERT_EQ(windows.size(), 3U);  // the tenth cycle fills no window
  for (std::size_t k = 0; k < 3; ++k) {
    const double first = 3.0 * static_cast<double>(k);
    EXPECT_EQ(windows[k].first_cycle, 3 * static_cast<std::int64_t>(k));
    EXPECT_NEAR((*windows[k].drive)[0].gamma(), 1 + first / 10, 1e-12);
    EXPECT_NEAR((*windows[k].drive)[1].gamma(), 1 + (first + 3) / 10, 1e-12);
    EXPECT_NEAR(find_result(windows[k].results, "h_cm").value(), 1 + 0.1 * (first + 1), 1e-12);
  }
  EXPECT_EQ(analyze_windows(run, {.discard_cycles = 4, .only = {"h_cm"}}, 3).front().first_cycle, 4);
  const std::string csv = windows_csv(windows);
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "first_cycle,cycles,gamma_begin,gamma_end,omega_begin,omega_end,h_cm,h_cm_low,h_cm_high");
  EXPECT_NE(csv.find("\n3,3,1.3,1.6,1,1,1.4,"), std::string::npos) << csv;
}

TEST(Windows, NoneContainsTheTurnOfTheDrive) {
  MemoryTrajectory run = ramped_run();
  run.info().drive->ramp->returns = true;  // Gamma 1 to 2 in cycles 0 to 4, and back in 5 to 9
  std::vector<CycleRange> left_out;
  const std::vector<Window> windows =
      analyze_windows(run, {.only = {"h_cm"}}, 3, Progress::none(), &left_out);
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_EQ(windows[0].first_cycle, 0);
  EXPECT_EQ(windows[1].first_cycle, 5);
  EXPECT_NEAR((*windows[1].drive)[0].gamma(), 2, 1e-12);
  EXPECT_NEAR((*windows[1].drive)[1].gamma(), 1.4, 1e-12);
  EXPECT_NEAR(find_result(windows[1].results, "h_cm").value(), 1.6, 1e-12);
  EXPECT_EQ(left_out, (std::vector<CycleRange>{{3, 4}, {8, 9}}));
  EXPECT_EQ(analyze_windows(run, {.discard_cycles = 7, .only = {"h_cm"}}, 3).front().first_cycle, 7);
}

TEST(Windows, NoTwoColumnsHaveOneName) {
  const std::string csv = windows_csv(analyze_windows(ramped_run(), {.rest_height = 1}, 5));
  std::set<std::string> seen;
  std::istringstream heading(csv.substr(0, csv.find('\n')));
  for (std::string name; std::getline(heading, name, ',');) EXPECT_TRUE(seen.insert(name).second) << name;
  EXPECT_TRUE(seen.contains("contact_force_density_low"));
}

// A run whose drive changes has no result of its own, only its windows have.
TEST(Windows, AChangingDriveNeedsThem) {
  const MemoryTrajectory run = ramped_run();
  EXPECT_NE(complaint_of([&] { analyze(run, {.only = {"h_cm"}}); }).find("the drive changes during the run"),
            std::string::npos);
  EXPECT_NEAR(find_result(analyze(run, {.discard_cycles = 2, .cycles = 1, .only = {"h_cm"}}), "h_cm").value(),
              1.2, 1e-12);
  for (const char* name : {"T_bar", "delta_h_bar"})
    EXPECT_NE(find_result(analyze(run, {.cycles = 2, .rest_height = 1, .only = {name}}), name)
                  .absent.find("drive.ramp"),
              std::string::npos)
        << name;
}

TEST(Windows, TheirFigureHasBothDirections) {
  MemoryTrajectory run = ramped_run();
  run.info().drive->ramp->returns = true;  // Gamma 1 to 2 in 5 cycles, and back
  const std::vector<Figure> figures = windows_figures(analyze_windows(run, {.only = {"h_cm"}}, 1), {"h_cm"});
  ASSERT_EQ(figures.size(), 1U);
  const std::string& data = figures.front().data;
  EXPECT_EQ(figures.front().name, "windows_h_cm");
  // Gamma in the middle of a cycle, and the height of that cycle.
  const std::size_t falling = data.find("# falling");
  EXPECT_LT(data.find("\n1.1 1 "), falling) << data;
  EXPECT_LT(data.find("\n1.9 1.4 "), falling) << data;
  EXPECT_GT(data.find("\n1.9 1.5 "), falling) << data;
  EXPECT_NE(data.find("\n1.1 1.9 "), std::string::npos) << data;
  EXPECT_NE(figures.front().plot.find("'falling'"), std::string::npos);
}

TEST(Windows, ImpossibleOnesAreRefused) {
  MemoryTrajectory run = ramped_run();
  const auto said = [&](const AnalysisOptions& options, std::int64_t cycles) {
    return complaint_of([&] { analyze_windows(run, options, cycles); });
  };
  EXPECT_NE(said({}, 0).find("a window of 0 cycles is empty"), std::string::npos);
  EXPECT_NE(said({}, 11).find("no window of 11 cycles fits into the trajectory"), std::string::npos);
  EXPECT_NE(said({.cycles = 2}, 3).find("cycles"), std::string::npos);
  run.info().columns.phase = false;
  EXPECT_NE(said({}, 3).find("no cycle number"), std::string::npos);
}

}  // namespace
}  // namespace twincell::analysis::windows_test
