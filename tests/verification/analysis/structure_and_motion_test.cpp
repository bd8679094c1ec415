// g(r), mean squared displacement and a2 of beds whose values are known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "analysis/gas/velocity_distribution.hpp"
#include "analysis/motion/mean_squared_displacement.hpp"
#include "analysis/order/pair_correlation.hpp"
#include "tests/support/known_beds.hpp"

namespace twincell::structure_and_motion_test {

using namespace analysis;
using namespace test;

namespace {

using Random = std::mt19937_64;

void validate_close(const std::string& what, double measured, double expected, double tolerance) {
  EXPECT_NEAR(measured, expected, tolerance) << what;
}

/// Mean of g(r) over the bins from `from` to `to`, each weighted by its content.
double mean_g(const MemoryTrajectory& t, double from, double to) {
  const auto g = values_of(t, "g_r");
  double sum = 0, all = 0;
  for (std::size_t b = 0; b < g.size(); ++b) {
    const double r = (static_cast<double>(b) + 1) * kPairCorrelationWidth;
    if (r < from || r > to) continue;
    const double weight = t.info().box.dimension == 2 ? r : r * r;
    sum += weight * g[b];
    all += weight;
  }
  return sum / all;
}

}  // namespace

TEST(PairCorrelation, OfPointsWithoutInteractionIsOne) {
  for (const int dimension : {2, 3})
    for (const bool periodic : {false, true}) {
      const MemoryTrajectory t = ideal_gas(dimension, periodic);
      // Points reach the walls, beads do not: the window is wider than the space of the points by half a
      // diameter at each end, less the tails of 3 of 600 points, which reach 4/601 of the width on average.
      double expected = 1;
      for (int axis = 0; axis < 3 && !periodic; ++axis)
        if (dimension == 3 || axis != 1) {
          const double width = t.info().box.size()[axis];
          expected *= (width * (1 - 8.0 / 601) + 1) / width;
        }
      for (const auto& [from, to] : {std::pair{0.0, 1.0}, std::pair{1.0, 2.5}, std::pair{2.5, 4.0}}) {
        const double g = mean_g(t, from, to);
        // 60 frames of 600 beads: 1e4 pairs and more in each range
        validate_close("g(r) of an ideal gas", g, expected, 0.03);
      }
    }
}

// A bead is no neighbour of its own, so few points without interaction have 1 and not 1 - 1/N.
TEST(PairCorrelation, OfFewPointsInAPeriodIsOneToo) {
  constexpr int kPoints = 10, kFrames = 4000;
  constexpr double kPeriod = 9;
  for (const int dimension : {2, 3}) {
    MemoryTrajectory gas = empty(dimension, Vec3(kPeriod, dimension == 3 ? kPeriod : 1, kPeriod), true);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0, kPeriod);
    for (int t = 0; t < kFrames; ++t) {
      std::vector<Vec3> points;
      for (int i = 0; i < kPoints; ++i)
        points.emplace_back(place(random), dimension == 3 ? place(random) : 0, place(random));
      add(gas, points);
    }
    // 45 pairs in each frame, of which 0.61 in 2D and 0.35 in 3D are within 4 sigma: a standard error of
    // 0.003 or 0.004. 1 - 1/N would be 0.9.
    validate_close("g(r) of ten points", mean_g(gas, 0, 4), 1, 0.02);
  }
}

// Pairs farther apart than half a period have several images, of which the nearest is counted: there is no
// value.
TEST(PairCorrelation, EndsAtHalfAPeriod) {
  TrajectoryInfo info;
  info.n_beads = 72;
  info.box.upper = Vec3(6, 1, 6);
  info.box.boundary = {Boundary::periodic, Boundary::open, Boundary::periodic};
  MemoryTrajectory gas(info);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> place(0, 6);
  for (int t = 0; t < 200; ++t) {
    Frame frame;
    frame.step = t;
    for (int i = 0; i < 72; ++i) frame.position.emplace_back(place(random), 0, place(random));
    gas.append(frame);
  }
  const auto results = analyze(gas, {.only = {"g_r", "g_r_distance"}});
  const Result &g = find_result(results, "g_r"), &r = find_result(results, "g_r_distance");
  std::size_t known = 0;
  for (std::size_t b = 0; b < g.values.size(); ++b) {
    EXPECT_EQ(std::isnan(g.values[b]), r.values[b] > 3 - kPairCorrelationWidth / 2) << r.values[b];
    if (std::isnan(g.values[b])) continue;
    EXPECT_NEAR(g.values[b], 1, 0.15) << r.values[b];
    ++known;
  }
  EXPECT_EQ(known, 59U);  // up to 2.95: the last bin ends at 2.975
}

TEST(PairCorrelation, CountsTheShellsOfATriangularLattice) {
  constexpr int kColumns = 12, kRows = 14;
  constexpr double kSpacing = 1.02;
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, kRows, kSpacing), true);
  add(t, triangular_lattice(kColumns, kRows, kSpacing));
  // that of the other beads
  const double density = 2 / (std::sqrt(3.0) * kSpacing * kSpacing) * (1 - 1.0 / (kColumns * kRows));
  const auto shell = [&](double r) {  // beads between 0.9 and 1.1 r
    const auto g = values_of(t, "g_r");
    double n = 0;
    for (std::size_t b = 0; b < g.size(); ++b) {
      const double inner = (static_cast<double>(b) + 0.5) * kPairCorrelationWidth,
                   outer = inner + kPairCorrelationWidth;
      if (inner > 0.93 * r && outer < 1.07 * r)
        n += g[b] * density * std::numbers::pi * (outer * outer - inner * inner);
    }
    return n;
  };
  validate_close("neighbours at a", shell(kSpacing), 6, 1e-9);
  validate_close("neighbours at sqrt(3) a", shell(std::sqrt(3.0) * kSpacing), 6, 1e-9);
  validate_close("neighbours at sqrt(7) a", shell(std::sqrt(7.0) * kSpacing), 12, 1e-9);
  EXPECT_NEAR(values_of(t, "g_peak_distance")[0], kSpacing, kPairCorrelationWidth / 2);
}

// Beads of diameter 1 in contact are in the middle of a bin, so that rounding does not split their peak.
TEST(PairCorrelation, OfALatticeInContactPeaksAtOne) {
  constexpr int kColumns = 12, kRows = 14;
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, kRows, 1), true);
  add(t, triangular_lattice(kColumns, kRows, 1));
  EXPECT_NEAR(values_of(t, "g_peak_distance")[0], 1, 1e-12);
  // 6 neighbours in the bin from 0.975 to 1.025, whose area is 0.1 pi
  const double others = 1 - 1.0 / (kColumns * kRows);
  const double expected =
      6 / (2 / std::sqrt(3.0) * others * std::numbers::pi * (1.025 * 1.025 - 0.975 * 0.975));
  validate_close("g(1) of a triangular lattice in contact", values_of(t, "g_peak")[0], expected, 1e-9);
  const auto r = values_of(t, "g_r_distance");
  ASSERT_EQ(r.size(), 80U);
  EXPECT_NEAR(r.front(), 0.05, 1e-12);
  EXPECT_NEAR(r.back(), 4, 1e-12);
}

TEST(PairCorrelation, OfABedOnWallsHasTheSameShells) {
  // The same lattice between walls: the reference beads are those inside.
  constexpr double kSpacing = 1.02;
  const double height = kSpacing * std::sqrt(3.0) / 2;
  MemoryTrajectory t = empty(2, Vec3(20 * kSpacing, 1, 40), false);
  std::vector<Vec3> beads;
  for (int row = 0; row < 22; ++row)
    for (int column = 0; column < 20; ++column)
      beads.emplace_back((column + 0.25 + 0.5 * (row % 2)) * kSpacing, 0, 0.5 + row * height);
  beads.emplace_back(10, 0, 35);  // one bead flies
  add(t, beads);
  const auto g = values_of(t, "g_r");
  const double density = 2 / (std::sqrt(3.0) * kSpacing * kSpacing);
  double n = 0;
  for (std::size_t b = 18; b < 23; ++b) {
    const double inner = (static_cast<double>(b) + 0.5) * kPairCorrelationWidth,
                 outer = inner + kPairCorrelationWidth;
    n += g[b] * density * std::numbers::pi * (outer * outer - inner * inner);
  }
  validate_close("neighbours in a bed with walls", n, 6, 0.2);  // by the density of the window, 3 %
}

TEST(MeanSquaredDisplacement, LinearForARandomWalkQuadraticForStreams) {
  constexpr double kStep = 0.1;
  Random random(7);
  std::normal_distribution<double> step(0, kStep);
  MemoryTrajectory walk = empty(2, Vec3(50, 1, 50), false), stream = walk;
  std::vector<Vec3> a(400, Vec3(25, 0, 25)), b = a;
  for (int f = 0; f < 120; ++f) {
    for (Vec3& r : a) r += Vec3(step(random) + 0.03, 0, step(random));  // the drift is taken off
    for (std::size_t i = 0; i < b.size(); ++i) b[i] += Vec3(i % 2 == 0 ? 0.01 : -0.01, 0, 0.02);
    add(walk, a);
    add(stream, b);
  }
  const auto of_walk = values_of(walk, "msd"), of_stream = values_of(stream, "msd");
  ASSERT_EQ(of_walk.size(), kLongestLag);
  for (const std::size_t lag : {1U, 4U, 16U, 32U}) {
    const auto m = static_cast<double>(lag);
    validate_close("msd of a random walk over 2 d D t", of_walk[lag - 1] / (2 * kStep * kStep * m), 1, 0.06);
    // n/(n - 1): the mean displacement of 400 beads is estimated
    validate_close("msd of two streams over (v t)^2", of_stream[lag - 1] / (1e-4 * m * m), 400.0 / 399, 1e-9);
  }
}

// Frames that belong to no drive, one of which is missing, give the displacements of the others.
TEST(MeanSquaredDisplacement, CountsFramesWithoutPhases) {
  constexpr double kSpeed = 0.1;  // sigma a frame, two streams
  TrajectoryInfo info = empty(2, Vec3(50, 1, 50), false).info();
  info.columns.phase = false;
  info.phases_per_cycle = 0;
  info.n_beads = 400;
  MemoryTrajectory t(info);
  for (int f = 0; f < 40; ++f) {
    if (f == 7) continue;
    Frame frame;
    frame.step = f;
    frame.time = 0.04 * f;
    frame.phase = frame.cycle = -1;
    for (int i = 0; i < 400; ++i) frame.position.emplace_back(25 + (i % 2 == 0 ? f : -f) * kSpeed, 0, 25);
    t.append(frame);
  }
  const std::vector<Result> all = analyze(t, {.only = {"msd", "msd_lag"}});
  const Result &msd = find_result(all, "msd"), &lag = find_result(all, "msd_lag");
  ASSERT_TRUE(msd.present()) << msd.absent;
  EXPECT_EQ(lag.unit, "frames");
  for (const std::size_t m : {1U, 2U, 5U, 32U})
    validate_close("msd of two streams over (v m)^2",
                   msd.values[m - 1] / std::pow(kSpeed * static_cast<double>(m), 2), 400.0 / 399, 1e-9);
}

TEST(MeanSquaredDisplacement, LiesInItsInterval) {
  // Random walks of 12 beads over 200 cycles: 2 d D m T is inside 95 % of the intervals.
  constexpr double kStep = 0.1;
  Random random(8);
  std::normal_distribution<double> step(0, kStep);
  for (const std::size_t lag : {1U, 3U}) {
    int held = 0;
    constexpr int kWalks = 400;
    for (int k = 0; k < kWalks; ++k) {
      MemoryTrajectory walk = empty(2, Vec3(50, 1, 50), false);
      std::vector<Vec3> a(12, Vec3(25, 0, 25));
      for (int f = 0; f < 200; ++f) {
        for (Vec3& r : a) r += Vec3(step(random), 0, step(random));
        add(walk, a);
      }
      AnalysisOptions options;
      options.only = {"msd_low", "msd_high"};
      const auto results = analyze(walk, options);
      const double expected = 2 * kStep * kStep * static_cast<double>(lag);
      held += find_result(results, "msd_low").values[lag - 1] <= expected &&
                      expected <= find_result(results, "msd_high").values[lag - 1]
                  ? 1
                  : 0;
    }
    // the standard error of 95 % in 400 is 1.1 %
    validate_close("coverage of msd, %", 100.0 * held / kWalks, 95, 3.5);
  }
}

TEST(VelocityDistribution, OfFewBeadsHasNoBias) {
  Random random(11);
  std::normal_distribution<double> gauss(3, 0.5);
  std::uniform_real_distribution<double> flat(-1, 1);
  MemoryTrajectory t = empty(2, Vec3(10, 1, 10), false), many = t;
  for (int f = 0; f < 20000; ++f) {
    std::vector<Vec3> v;
    for (int i = 0; i < 10; ++i) v.emplace_back(gauss(random), 0, flat(random));
    add(t, std::vector<Vec3>(v.size(), Vec3(1, 0, 1)), v);
  }
  for (int f = 0; f < 60; ++f) {
    std::vector<Vec3> v;
    for (int i = 0; i < 5000; ++i) v.emplace_back(gauss(random), 0, flat(random));
    add(many, std::vector<Vec3>(v.size(), Vec3(1, 0, 1)), v);
  }
  validate_close("a2 of ten Gaussian velocities", values_of(t, "a2_x")[0], 0, 0.01);
  validate_close("a2 of Gaussian velocities", values_of(many, "a2_x")[0], 0, 0.01);
  validate_close("a2 of a uniform distribution", values_of(many, "a2_z")[0], -0.4, 0.005);
}

}  // namespace twincell::structure_and_motion_test
