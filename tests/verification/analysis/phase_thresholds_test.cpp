// V4.9, V5.4: s_b of the completely inelastic rigid bed, s_c of an imposed shear: closed forms, no dynamics.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <sstream>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/motion/bouncing_measure.hpp"
#include "tests/support/rigid_bed.hpp"
#include "tests/support/validation.hpp"

namespace twincell::phase_thresholds_test {

using namespace analysis;
using test::RigidBed;

namespace {

double measured_s_b(double gamma, SbForm form, int phases = 240) {
  AnalysisOptions options;
  options.s_b = form;
  options.only = {"s_b"};
  const auto results = analyze(
      test::rigid_bed({.gamma = gamma, .columns = 6, .rows = 5, .phases = phases, .cycles = 2}), options);
  return find_result(results, "s_b").value();
}

}  // namespace

TEST(BouncingThreshold, TableOfTheRigidInelasticBed) {
  const std::vector<std::array<double, 3>> table = {
      {1.05, 0.0027, 0.0029}, {1.10, 0.0119, 0.0131}, {1.15, 0.0279, 0.0314},
      {1.20, 0.0502, 0.0577}, {1.30, 0.1122, 0.1333}, {1.40, 0.1945, 0.2376},
      {1.50, 0.2935, 0.3677}, {1.80, 0.6663, 0.8898}, {2.00, 0.9586, 1.3282}};
  for (const auto& [gamma, variance, about_rest] : table) {
    const double s_b = measured_s_b(gamma, SbForm::variance),
                 s_rest = measured_s_b(gamma, SbForm::about_rest);
    std::ostringstream at;
    at << "rigid inelastic bed, Gamma = " << gamma << ": s_b";
    test::validate({"V4.9", at.str(), variance, 1e-3, "closed form"}, s_b);
    test::validate({"V4.9", at.str() + " about rest", about_rest, 1e-3, "closed form"}, s_rest);
  }
}

// A file whose first frame is one of a flight does not know where the bed rests.
TEST(BouncingThreshold, TheHeightOfAFlyingBedIsNoRestHeight) {
  const auto film = test::rigid_bed({.gamma = 2.0, .columns = 6, .rows = 5, .phases = 40, .cycles = 3});
  // The film with the heights of its first frame moved by `rise`, and with velocities if a speed is stated.
  const auto about_rest = [&](double rise, std::optional<double> speed) {
    TrajectoryInfo info = film.info();
    info.columns.velocity = speed.has_value();
    MemoryTrajectory changed(info);
    for (std::size_t f = 0; f < film.n_frames(); ++f) {
      Frame frame = film.frames()[f];
      if (f == 0)
        for (Vec3& r : frame.position) r.z() += rise;
      if (speed) frame.velocity.assign(frame.position.size(), Vec3(0, 0, *speed));
      changed.append(frame);
    }
    return find_result(analyze(changed, {.only = {"s_b_about_rest"}}), "s_b_about_rest");
  };
  EXPECT_TRUE(about_rest(0, {}).present());
  EXPECT_NE(about_rest(0.5, {}).absent.find("do not lie at rest in the first"), std::string::npos);
  // Velocities decide: a bed that is compacted lies lower later.
  EXPECT_TRUE(about_rest(0.5, 0.0).present());
  EXPECT_NE(about_rest(0, 3.0).absent.find("does not lie at rest in the first frame"), std::string::npos);
}

TEST(BouncingThreshold, CriticalGamma) {
  const auto critical = [](SbForm form) {
    double low = 1.1, high = 1.25;
    for (int i = 0; i < 13; ++i)
      (measured_s_b((low + high) / 2, form) < kBouncingThreshold ? low : high) = (low + high) / 2;
    return (low + high) / 2;
  };
  const double variance = critical(SbForm::variance), rest = critical(SbForm::about_rest);
  test::validate({"V4.9", "rigid inelastic bed: Gamma at which s_b = sigma/30", 1.1636, 2e-4, "closed form"},
                 variance);
  test::validate(
      {"V4.9", "rigid inelastic bed: Gamma at which s_b about rest = sigma/30", 1.1542, 2e-4, "closed form"},
      rest);
}

TEST(BouncingThreshold, IntervalsHoldTheirValueWhereTracersRestAtDifferentHeights) {
  // A bed that moves with its plate, as seen by a camera: s_b consists of noise only, while the rest heights
  // of the tracers differ by a tenth of a diameter.
  constexpr std::size_t kTracers = 12;
  constexpr int kPhases = 10, kCycles = 6;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> rest(3, 0.1), noise(0, 0.002);
    TrajectoryInfo info;
    info.n_beads = kTracers;
    info.box.upper = Vec3(20, 1, 10);
    info.phases_per_cycle = kPhases;
    info.columns.phase = info.columns.plate_height = true;
    info.tracer.assign(kTracers, 1);
    MemoryTrajectory bed(info);
    std::vector<double> height(kTracers);
    for (double& z : height) z = rest(generator);
    for (int c = 0; c < kCycles; ++c)
      for (int k = 0; k < kPhases; ++k) {
        Frame f;
        f.cycle = c;
        f.phase = k;
        f.plate_height = 0;
        for (std::size_t t = 0; t < kTracers; ++t)
          f.position.emplace_back(1.0 + static_cast<double>(t), 0, height[t] + noise(generator));
        bed.append(f);
      }
    AnalysisOptions options;
    options.only = {"s_b", "s_b_about_rest", "s_b_as_printed"};
    for (const Result& r : analyze(bed, options)) {
      ASSERT_TRUE(r.present()) << r.absent;
      ASSERT_TRUE(r.interval.has_value()) << r.name << ": " << r.no_interval;
      EXPECT_LE(r.interval->low, r.value()) << r.name << ", seed " << seed;
      EXPECT_GE(r.interval->high, r.value()) << r.name << ", seed " << seed;
      EXPECT_LT(r.interval->low, r.interval->high) << r.name << ", seed " << seed;
      // If the bootstrap kept the rest height fixed, the interval would be that of the tracers' rest heights,
      // 0.1/sqrt(12).
      if (r.name == "s_b_about_rest") {
        EXPECT_LT(r.interval->high, 0.01) << seed;
      }
    }
  }
}

TEST(BouncingThreshold, AsPrintedIsTheHeightOfTheTracers) {
  // 5 rows: the tracers are the third row, 0.5 + 2 (sqrt 3/2) above the plate.
  const double printed = measured_s_b(0.5, SbForm::as_printed, 20);
  EXPECT_NEAR(printed, 0.5 + std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(measured_s_b(0.5, SbForm::variance, 20), 0, 1e-12);
}

TEST(ConvectionThreshold, ImposedShearHasTheVarianceOfItsLine) {
  const double shear = 0.03;
  const int cycles = 12, columns = 20;
  const auto results = analyze(
      test::rigid_bed({.gamma = 1.5, .columns = columns, .cycles = cycles, .shear_per_cycle = shear}));
  const Result& s_j = find_result(results, "s_j");
  ASSERT_EQ(s_j.values.size(), static_cast<std::size_t>(cycles));
  // The tracers are one row of n beads a distance 1 apart: var(x) = (n^2 - 1)/12.
  const double n = find_result(results, "s_j").convention.find("spread of 20") != std::string::npos ? 20 : 19;
  const double var_x = (n * n - 1) / 12;
  double mean_j2 = 0;
  for (int j = 0; j < cycles; ++j) {
    EXPECT_NEAR(s_j.values[static_cast<std::size_t>(j)], shear * j * std::sqrt(var_x), 1e-12);
    mean_j2 += static_cast<double>(j) * j / cycles;
  }
  test::validate({"V5.4", "s_c of a line that shears by 0.03 a cycle, 12 cycles",
                  shear * std::sqrt(var_x * mean_j2), 1e-12, "closed form"},
                 find_result(results, "s_c").value());
  // s_j first exceeds sigma at the first j > 1/(a sd(x)).
  EXPECT_EQ(find_result(results, "cycle_of_convection").value(),
            std::floor(1 / (shear * std::sqrt(var_x))) + 1);
}

TEST(PhaseLabel, FollowsTheTwoThresholds) {
  const auto label = [](double gamma, double shear) {
    return find_result(analyze(test::rigid_bed({.gamma = gamma, .cycles = 10, .shear_per_cycle = shear})),
                       "phase")
        .text;
  };
  EXPECT_EQ(label(1.10, 0), "co-moving");
  EXPECT_EQ(label(1.20, 0), "bouncing");
  EXPECT_EQ(label(1.80, 0.1), "convecting");
  const double nan = std::nan("");
  EXPECT_EQ(bed_phase(1.0 / 30, 0), BedPhase::co_moving);
  EXPECT_EQ(bed_phase(1, 1), BedPhase::bouncing);
  EXPECT_EQ(bed_phase(1, std::nextafter(1.0, 2.0)), BedPhase::convecting);
  EXPECT_EQ(bed_phase(nan, 5), BedPhase::undetermined);
  EXPECT_EQ(bed_phase(1, nan), BedPhase::undetermined);
  EXPECT_EQ(bed_phase(0.01, nan), BedPhase::co_moving);
}

TEST(BouncingThreshold, ABedOfPeriodTwoIsAveragedOverAnEvenNumberOfCycles) {
  // The bed is lifted by 1 at phase 5 of odd cycles only. Over an even number of cycles s(5) is 1/2; over 3
  // cycles it would be 1/3.
  MemoryTrajectory flat = test::rigid_bed({.gamma = 0.9, .cycles = 3});
  MemoryTrajectory lifted(flat.info());
  for (Frame frame : flat.frames()) {
    if (frame.phase == 5 && frame.cycle % 2 == 1)
      for (Vec3& r : frame.position) r.z() += 1;
    lifted.append(frame);
  }
  const auto results = analyze(lifted);
  const Result& s_k = find_result(results, "s_k");
  EXPECT_EQ(s_k.n, 2U);
  EXPECT_NEAR(s_k.values[5] - s_k.values[4], 0.5, 1e-12);
}

}  // namespace twincell::phase_thresholds_test
