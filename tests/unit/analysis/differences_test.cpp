// Contributions to a difference between experiment and simulation, on numbers whose contributions are set by
// hand.
#include "analysis/runs/differences.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/rigid_bed.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis::differences_test {
namespace {

using Runs = std::vector<Run>;  // in the body of a test `Run` is a name of googletest

Result number(const std::string& name, double value, double error) {
  Result r{.name = name, .values = {value}};
  r.unit = "sigma";
  r.interval =
      Interval{.low = value - 1.96 * error, .high = value + 1.96 * error, .level = 0.95, .method = "set"};
  return r;
}

Run run(Side side, double value, double error, const std::string& start = "random") {
  Run r;
  r.side = side;
  r.gamma = 2;
  r.n_l = 20;
  r.start = side == Side::simulation ? start : "";
  r.results = {number("s_b", value, error)};
  return r;
}

Difference only(const std::vector<Run>& runs, const Checks& checks = {}) {
  const auto all = find_differences(runs, match_runs(runs), checks);
  EXPECT_EQ(all.size(), 1U);
  return all.at(0);
}

}  // namespace

TEST(Differences, CameraAndRemainderAddUp) {
  const Runs runs = {run(Side::experiment, 1.0, 0.03), run(Side::simulation, 0.7, 0.02)};
  Checks checks;
  checks.filmed.push_back(
      {.run = 1, .seen = {number("s_b", 0.71, 0.02)}, .filmed = {number("s_b", 0.96, 0.04)}});
  const Difference d = only(runs, checks);
  EXPECT_NEAR(d.difference(), 0.3, 1e-12);
  EXPECT_NEAR(d.camera.value(), 0.25, 1e-12);
  EXPECT_NEAR(d.remainder(), 0.05, 1e-12);
  EXPECT_NEAR(d.camera.value() + d.remainder(), d.difference(), 1e-12);
  // 0.03 and 0.04 in quadrature: of simulation and virtual experiment the larger error, 0.04, counts.
  EXPECT_NEAR(d.statistics.value(), 0.05, 1e-9);
  EXPECT_NEAR(d.in_errors().value(), 1, 1e-6);
  EXPECT_NE(d.attribution().find("camera and tracking cause 83 %"), std::string::npos) << d.attribution();
}

// The lattice of 44.75 degrees is that of -15.25 degrees.
TEST(Differences, OrientationsAreComparedByTheirPeriod) {
  const auto turned = [](Side side, double degrees) {
    auto r = run(side, 1, 0.01);
    r.results = {number("orientation", degrees, 0.1)};
    return r;
  };
  const Difference d = only(
      {turned(Side::experiment, -14.6), turned(Side::simulation, 44.7), turned(Side::simulation, -14.9)});
  EXPECT_NEAR(d.difference(), 0.5, 1e-9);
  EXPECT_NEAR(d.seeds.value(), 0.4 / std::sqrt(2.0), 1e-9);
}

TEST(Differences, TheHeightIsNamedIfThereAreSeveral) {
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01)};
  const auto text = [&] {
    const auto matches = match_runs(runs);
    return real_differences_text(find_differences(runs, matches, {}), matches);
  };
  EXPECT_EQ(text().find("N_l"), std::string::npos) << text();
  for (const double value : {0.9, 0.4}) {
    runs.push_back(run(value > 0.5 ? Side::experiment : Side::simulation, value, 0.01));
    runs.back().n_l = 40;
  }
  EXPECT_EQ(text().substr(0, 38), "  Gamma   N_l  real difference        ") << text();
  EXPECT_NE(text().find("  2.000    20  s_b "), std::string::npos) << text();
  EXPECT_NE(text().find("  2.000    40  s_b "), std::string::npos) << text();
}

// 0.3 apart, of which camera and tracking cause 0.2; the remaining 0.1 is four errors of 0.025.
TEST(Differences, SignificantDifferencesAreRowsAndOpenQuestionsAreListedOnce) {
  const Runs runs = {run(Side::experiment, 1.0, 0.015), run(Side::simulation, 0.7, 0.02)};
  Checks checks;
  checks.filmed.push_back(
      {.run = 1, .seen = {number("s_b", 0.7, 0.02)}, .filmed = {number("s_b", 0.9, 0.02)}});
  const auto matches = match_runs(runs);
  EXPECT_EQ(real_differences_text(find_differences(runs, matches, checks), matches),
            "  Gamma  real difference           experiment  simulation  difference    errors\n"
            "  2.000  s_b                                1         0.7         0.3       4.0  camera 67 %\n"
            "one start alone does not show whether defects cause a difference\n"
            "0 other numbers agree within their errors (differences.csv in the report).\n");
  EXPECT_EQ(real_differences_text({}, {}), "");
}

TEST(Differences, MissingFilmIsReportedOnlyWithoutFilm) {
  Runs runs = {run(Side::experiment, 1.0, 0.015), run(Side::simulation, 0.7, 0.02)};
  for (auto& r : runs) r.results.push_back(number("q6", r.side == Side::experiment ? 0.7 : 0.5, 0.01));
  const auto matches = match_runs(runs);
  Checks checks;
  const auto text = [&] { return real_differences_text(find_differences(runs, matches, checks), matches); };
  EXPECT_NE(text().find("nothing was filmed"), std::string::npos) << text();
  checks.filmed.push_back(
      {.run = 1, .seen = {number("s_b", 0.7, 0.02)}, .filmed = {number("s_b", 0.9, 0.02)}});
  EXPECT_EQ(text().find("nothing was filmed"), std::string::npos) << text();
  EXPECT_NE(text().find("1 of these numbers is not known in the filmed simulation"), std::string::npos)
      << text();
}

// A scale wrong by 0.1 % changes a length of 4 by 0.004 and an area of 4 by 0.008; a ratio not at all.
TEST(Differences, TheErrorOfTheScaleIsPartOfTheErrorOfALength) {
  Runs runs = {run(Side::experiment, 4.004, 1e-4), run(Side::simulation, 4, 1e-4)};
  EXPECT_TRUE(only(runs).is_real());
  EXPECT_FALSE(only(runs).scale);
  runs[0].scale_error = 1e-3;
  EXPECT_NEAR(only(runs).scale.value(), 4.004e-3, 1e-9);
  EXPECT_NEAR(only(runs).in_errors().value(), 1, 2e-3);
  EXPECT_FALSE(only(runs).is_real());
  EXPECT_NE(only(runs).attribution().find("largest part is scale"), std::string::npos)
      << only(runs).attribution();
  for (auto& r : runs) r.results[0].unit = "sigma^2";
  EXPECT_NEAR(only(runs).scale.value(), 8.008e-3, 1e-9);
  for (auto& r : runs) r.results[0].unit = "1";
  EXPECT_FALSE(only(runs).scale);
  EXPECT_TRUE(only(runs).is_real());
}

// phi_cm has no unit, but is an area over an area that is measured; T_bar is over the square of A omega.
TEST(Differences, ErrorsOfScaleAndDriveAreCarriedIntoNumbersWithoutUnit) {
  Runs runs = {run(Side::experiment, 0.5, 1e-4), run(Side::simulation, 0.5, 1e-4)};
  runs[0].scale_error = 1e-3;
  runs[0].amplitude_error = 2e-3;
  const auto rename = [&](const char* name) {
    for (auto& r : runs) r.results[0].name = name, r.results[0].unit = "1";
  };
  rename("phi_cm");
  EXPECT_NEAR(only(runs).scale.value(), 1e-3, 1e-9);
  EXPECT_FALSE(only(runs).drive);
  rename("T_bar");
  EXPECT_FALSE(only(runs).scale);
  EXPECT_NEAR(only(runs).drive.value(), 2e-3, 1e-9);
  EXPECT_NEAR(only(runs).error().value(), std::hypot(2e-3, only(runs).statistics.value()), 1e-9);
  rename("q6");
  EXPECT_FALSE(only(runs).scale);
  EXPECT_FALSE(only(runs).drive);
  EXPECT_NEAR(runs[0].drive_error().value(), std::hypot(1e-3, 2e-3), 1e-12);
  EXPECT_FALSE(runs[1].drive_error());
}

// Beads that rest on a plate of amplitude 0.5, which is wrong by 0.001, seem to bounce by the rms of
// 0.001 sin(omega t), and by more about the height of a single frame.
TEST(Differences, TheErrorOfTheAmplitudeIsPartOfTheErrorOfAHeightAboveThePlate) {
  Runs runs = {run(Side::experiment, 7e-4, 1e-5), run(Side::simulation, 1e-5, 1e-6)};
  runs[0].gamma = runs[1].gamma = 0.8;
  runs[0].k_m = 0.4;
  EXPECT_TRUE(only(runs).is_real());
  runs[0].amplitude_error = 2e-3;
  EXPECT_NEAR(only(runs).drive.value(), 1e-3 / std::numbers::sqrt2, 1e-12);
  EXPECT_FALSE(only(runs).is_real());
  for (auto& r : runs) r.results[0].name = "s_b_about_rest";
  EXPECT_NEAR(only(runs).drive.value(), 1e-3, 1e-12);
}

// The scale says nothing of the scatter of the numbers.
TEST(Differences, TheErrorOfTheScaleAloneIsNoError) {
  Runs runs = {run(Side::experiment, 4, 0), run(Side::simulation, 3, 0)};
  for (auto& r : runs) r.results[0].interval.reset();
  runs[0].scale_error = 1e-3;
  EXPECT_TRUE(only(runs).scale);
  EXPECT_FALSE(only(runs).error());
}

// One camera and cell: the errors of two scales do not average out.
TEST(Differences, ErrorsOfTheScaleOfSeveralExperimentsAreCommon) {
  Runs runs = {run(Side::experiment, 4, 1e-4), run(Side::experiment, 4, 1e-4),
               run(Side::simulation, 4, 1e-4)};
  runs[0].scale_error = 1e-3;
  runs[1].scale_error = 2e-3;
  EXPECT_NEAR(only(runs).scale.value(), 6e-3, 1e-9);
}

// S = 0.7, F = 0.5, E = 0.6: the remainder of 0.1 is many errors, but a smaller effect of the camera explains
// E.
TEST(Differences, WhatCameraAndTrackingCauseIsNotReal) {
  const Runs runs = {run(Side::experiment, 0.6, 0.001), run(Side::simulation, 0.7, 0.001)};
  Checks checks;
  checks.filmed.push_back(
      {.run = 1, .seen = {number("s_b", 0.7, 0.001)}, .filmed = {number("s_b", 0.5, 0.001)}});
  const Difference d = only(runs, checks);
  EXPECT_TRUE(d.is_beyond_error());
  EXPECT_FALSE(d.is_real());
  EXPECT_EQ(d.attribution(), "camera and tracking cause all of it");
  const auto matches = match_runs(runs);
  EXPECT_EQ(real_differences_text(find_differences(runs, matches, checks), matches),
            "camera and tracking cause all of the difference of 1 other number\n"
            "0 other numbers agree within their errors (differences.csv in the report).\n");
}

TEST(Differences, WithinTheErrorTheLargestSourceIsNamed) {
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.8, 0.01),
               run(Side::simulation, 1.2, 0.01), run(Side::simulation, 1.1, 0.01)};
  const Difference d = only(runs);
  EXPECT_NEAR(d.seeds.value(), 0.2082, 1e-4);  // standard deviation of 0.8, 1.2, 1.1
  EXPECT_FALSE(d.camera);
  EXPECT_NE(d.attribution().find("largest part is seeds"), std::string::npos) << d.attribution();
}

// Two runs 0.02 apart: s = 0.01414, and 1.96 times the seed error is the 95 % limit of Student's t with one
// degree of freedom, 12.706 s sqrt(3/2).
TEST(Differences, FewSeedsGiveAnErrorOfStudentsT) {
  const Runs runs = {run(Side::experiment, 1.0, 1e-6), run(Side::simulation, 0.81, 1e-6),
                     run(Side::simulation, 0.83, 1e-6)};
  const Difference d = only(runs);
  EXPECT_EQ(d.seed_runs, 2U);
  EXPECT_NEAR(1.96 * d.seed_error().value(), 12.706 * std::sqrt(1.5) * 0.02 / std::sqrt(2), 1e-4);
  EXPECT_NE(d.attribution().find("within its error"), std::string::npos) << d.attribution();
  EXPECT_NE(d.attribution().find("2 runs only"), std::string::npos) << d.attribution();
}

// Benjamini & Hochberg's rule at 5 %, on numbers whose probabilities follow from the normal law: p(2.5) =
// 0.0124, p(2.9) = 0.0037.
TEST(Differences, AmongManyNumbersAFewLargeErrorsAreChance) {
  const auto real_of = [](const std::vector<double>& errors) {
    Runs runs = {run(Side::experiment, 0, 0.1), run(Side::simulation, 0, 0.1)};
    for (auto& r : runs) r.results.clear();
    for (std::size_t k = 0; k < errors.size(); ++k) {
      const double shift = static_cast<double>(k + 1);  // no two numbers are the same
      runs[0].results.push_back(
          number(fmt::format("n_{}", k), shift + errors[k] * std::sqrt(2.0) * 0.1, 0.1));
      runs[1].results.push_back(number(fmt::format("n_{}", k), shift, 0.1));
    }
    const auto all = find_differences(runs, match_runs(runs), {});
    EXPECT_EQ(all.size(), errors.size());
    return std::count_if(all.begin(), all.end(), [](const Difference& d) { return d.is_real(); });
  };
  const auto with = [](std::size_t n, double t) {  // n of ten
    std::vector<double> errors(10, 0.5);
    for (std::size_t k = 0; k < n; ++k) errors[k] = t;
    return errors;
  };
  EXPECT_EQ(real_of({2.5}), 1);
  EXPECT_EQ(real_of(with(1, 2.5)), 0);  // 0.0124 > 0.05/10
  EXPECT_EQ(real_of(with(1, 2.9)), 1);  // 0.0037 < 0.05/10
  EXPECT_EQ(real_of(with(2, 2.5)), 0);  // 0.0124 > 0.05 2/10
  EXPECT_EQ(real_of(with(3, 2.5)), 3);  // 0.0124 < 0.05 3/10
  EXPECT_EQ(real_of(with(10, 1.97)), 0) << "never below two errors";
  EXPECT_EQ(real_of(with(10, 2.03)), 10);
}

TEST(Differences, ANumberThatRepeatsAnotherIsCountedOnce) {
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01)};
  for (auto& r : runs) r.results.push_back(number("s_b_variance", r.results[0].value(), 0.01));
  EXPECT_EQ(only(runs).quantity, "s_b");
}

TEST(Differences, EqualResultsAreReportedAsEqual) {
  EXPECT_NE(
      only({run(Side::experiment, 1.0, 0.01), run(Side::simulation, 1.0, 0.01)}).attribution().find("same"),
      std::string::npos);
}

TEST(Differences, AStartWithOtherDefectsMayBeTheReason) {
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01, "crystal_a"),
               run(Side::simulation, 0.9, 0.01, "random")};
  const Difference d = only(runs);
  EXPECT_NEAR(d.defects.value(), 0.4, 1e-12);
  EXPECT_FALSE(d.seeds);
  EXPECT_NE(d.attribution().find("starts with other defects"), std::string::npos) << d.attribution();
}

TEST(Differences, SignificantDifferencesAndUnknownErrorsAreReported) {
  const Difference real = only({run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01)});
  EXPECT_NE(real.attribution().find("real difference"), std::string::npos) << real.attribution();
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01)};
  for (auto& r : runs) r.results[0].interval.reset();
  EXPECT_NE(only(runs).attribution().find("no error is known"), std::string::npos);
}

// An error that is missing on one side is not 0.
TEST(Differences, WithoutAnErrorOnOneSideThereIsNoConclusion) {
  for (const Side side : {Side::experiment, Side::simulation}) {
    Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01)};
    for (auto& r : runs)
      if (r.side == side) r.results[0].interval.reset();
    const Difference d = only(runs);
    EXPECT_FALSE(d.is_real());
    EXPECT_NE(d.attribution().find(std::string("the error of the ") + side_name(side) + " is not known"),
              std::string::npos)
        << d.attribution();
  }
  // The scatter between seeds contains that within each of the simulations.
  Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.5, 0.01),
               run(Side::simulation, 0.51, 0.01), run(Side::simulation, 0.49, 0.01)};
  for (auto& r : runs)
    if (r.side == Side::simulation) r.results[0].interval.reset();
  EXPECT_TRUE(only(runs).is_real());
}

TEST(Differences, ANumberThatNeverChangedHasNoKnownError) {
  const Difference d = only({run(Side::experiment, 0.22, 1e-17), run(Side::simulation, 0.23, 1e-17)});
  EXPECT_FALSE(d.statistics);
  EXPECT_FALSE(d.experiment.error);
  EXPECT_NE(d.attribution().find("no error is known"), std::string::npos);
}

// Rows of 9, 10 and 9 beads sheared by 0.1 j per sigma: s_c = 0.1 sqrt(mean j^2) sqrt((n^2 - 1)/12); s_b is
// the same in every row.
TEST(Differences, LinesOfTracersInAShearedBed) {
  const test::RigidBed bed{.gamma = 1.5, .columns = 10, .rows = 9, .cycles = 4, .shear_per_cycle = 0.1};
  const TrajectoryInfo info = test::rigid_bed_info(bed);
  MemoryTrajectory trajectory(info);
  test::film_rigid_bed(bed, info, trajectory);
  const auto lines = tracer_lines(trajectory, 7, {});
  ASSERT_EQ(lines.size(), 2U);
  const double nine = 0.1 * std::sqrt(14.0 / 4) * std::sqrt(80.0 / 12),
               ten = 0.1 * std::sqrt(14.0 / 4) * std::sqrt(99.0 / 12);
  for (const auto& line : lines) {
    EXPECT_EQ(line.run, 7U);
    ASSERT_EQ(line.values.size(), 3U);
    EXPECT_NEAR(line.values[1] - line.values[0], line.quantity == "s_c" ? ten - nine : 0, 1e-6)
        << line.quantity;
    EXPECT_NEAR(line.values[1] - line.values[2], line.quantity == "s_c" ? ten - nine : 0, 1e-6)
        << line.quantity;
    if (line.quantity == "s_c") {
      EXPECT_NEAR(line.values[1], ten, 1e-6);
    }
  }
}

TEST(Differences, CommonTracerBiasCancels) {
  const Runs runs = {run(Side::experiment, 1.0, 0.01), run(Side::simulation, 0.9, 0.01)};
  Checks alike, apart;
  alike.tracers = {{0, "s_b", {0.5, 1.0, 1.5}}, {1, "s_b", {0.4, 0.9, 1.4}}};
  apart.tracers = {{0, "s_b", {0.5, 1.0, 1.5}}, {1, "s_b", {0.9, 0.9, 0.9}}};
  EXPECT_NEAR(only(runs, alike).tracers.value(), 0, 1e-12);
  EXPECT_NEAR(only(runs, apart).tracers.value(), 0.5, 1e-12);
}

}  // namespace twincell::analysis::differences_test
