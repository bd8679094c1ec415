#include "imaging/link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <random>

#include "analysis/trajectory/error.hpp"
#include "imaging/phase_lock.hpp"

using namespace twincell;

namespace {

// Touching crystal of n x n beads of diameter 15 px.
std::vector<PixelPoint> crystal(int n) {
  std::vector<PixelPoint> beads;
  for (int row = 0; row < n; ++row)
    for (int i = 0; i < n; ++i) beads.push_back({15 * (i + 0.5 * (row % 2)), 15 * std::sqrt(0.75) * row});
  return beads;
}

std::vector<PixelPoint> moved(std::vector<PixelPoint> beads, double dx, double dy) {
  for (PixelPoint& p : beads) p = {p.x_px + dx, p.y_px + dy};
  return beads;
}

std::vector<std::int64_t> counted(std::size_t n) {
  std::vector<std::int64_t> ids(n);
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

}  // namespace

TEST(Assign, IsTheCheapestOfAllPermutations) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> any(-5, 5);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t n = 1 + static_cast<std::size_t>(trial) % 5,
                      m = n + static_cast<std::size_t>(trial) % 3;
    std::vector<double> cost(n * m);
    for (double& c : cost) c = any(generator);
    std::vector<std::size_t> column(m);
    std::iota(column.begin(), column.end(), std::size_t{0});
    double least = 1e9;
    do {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += cost[i * m + column[i]];
      least = std::min(least, sum);
    } while (std::next_permutation(column.begin(), column.end()));
    const std::vector<std::size_t> chosen = assign(cost, n, m);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += cost[i * m + chosen[i]];
    worst = std::max(worst, std::abs(sum - least));
    std::vector<std::size_t> sorted = chosen;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  }
  std::cout << "largest excess over the cheapest assignment: " << worst << '\n';
  EXPECT_LE(worst, 1e-12);
}

TEST(Linker, ACrystalMovedAsAWholeKeepsItsNames) {
  for (const double step : {0.0, 0.3, 0.5, 0.8, 1.0}) {
    Linker linker({.diameter_px = 15});
    const auto start = crystal(12);
    EXPECT_EQ(linker.next(start), counted(start.size()));
    for (int f = 1; f <= 3; ++f) {
      EXPECT_EQ(linker.next(moved(start, 15 * step * f, 0)), counted(start.size())) << step << " d per frame";
      EXPECT_NEAR(linker.common_shift().x_px, 15 * step, 1e-9);
      EXPECT_NEAR(linker.common_shift().y_px, 0, 1e-9);
    }
  }
}

TEST(Linker, IndependentSteps) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> step(-2.5, 2.5);
  std::vector<PixelPoint> beads;
  for (int i = 0; i < 400; ++i) beads.push_back({30.0 * (i % 20), 30.0 * static_cast<int>(i / 20)});
  Linker linker({.diameter_px = 15});
  linker.next(beads);
  for (int f = 0; f < 10; ++f) {
    for (PixelPoint& p : beads) p = {p.x_px + step(generator), p.y_px + step(generator)};
    EXPECT_EQ(linker.next(beads), counted(beads.size()));
  }
}

TEST(Linker, AMissingBeadComesBackWithinMemoryAndNotAfter) {
  for (const int missing : {1, 3, 4}) {
    auto beads = crystal(6);
    Linker linker({.diameter_px = 15, .memory = 3});
    linker.next(beads);
    const PixelPoint last = beads.back();
    beads.pop_back();
    for (int f = 0; f < missing; ++f) EXPECT_EQ(linker.next(beads), counted(35));
    beads.push_back(last);
    const auto ids = linker.next(beads);
    EXPECT_EQ(ids.back(), missing <= 3 ? 35 : 36) << missing << " frames";
    EXPECT_EQ(linker.n_tracks(), missing <= 3 ? 36 : 37);
  }
}

TEST(Linker, BirthsAndLosses) {
  auto beads = crystal(5);
  Linker linker({.diameter_px = 15});
  linker.next(beads);
  beads.push_back({500, 500});
  EXPECT_EQ(linker.next(beads).back(), 25);
  beads.erase(beads.begin());
  EXPECT_EQ(linker.next(beads).front(), 1);
  EXPECT_TRUE(linker.next({}).empty());
  EXPECT_EQ(linker.next(beads).front(), 1);
  EXPECT_THROW(Linker({.diameter_px = 0}), ConfigError);
  EXPECT_THROW(Linker({.diameter_px = 15, .memory = -1}), ConfigError);
}

TEST(PixelFrame, RoundTrip) {
  const PixelFrame map{14.7, {33.25, 571.5}};
  const PixelPoint p = map.pixel_from_cell(map.cell_from_pixel({123.456, -7.89}));
  EXPECT_NEAR(p.x_px, 123.456, 1e-12);
  EXPECT_NEAR(p.y_px, -7.89, 1e-12);
  const Vec3 up = map.cell_from_pixel({33.25 + 14.7, 571.5 - 2 * 14.7});
  EXPECT_NEAR(up.x(), 1, 1e-12);
  EXPECT_NEAR(up.z(), 2, 1e-12);
}

TEST(PhaseLock, FramesToPhasesAndCycles) {
  const PhaseLock lock{20, 13};
  EXPECT_EQ(lock.phase(0), 13);
  EXPECT_EQ(lock.cycle(0), 0);
  EXPECT_EQ(lock.phase(6), 19);
  EXPECT_EQ(lock.phase(7), 0);
  EXPECT_EQ(lock.cycle(7), 1);
  EXPECT_DOUBLE_EQ(lock.fraction(12), 0.25);
  EXPECT_EQ(lock.phase(20LL * 1'000'000'000'000 + 1), 14);
  EXPECT_EQ(PhaseLock{}.phase(5), -1);
  EXPECT_EQ(PhaseLock{}.cycle(5), -1);
  EXPECT_THROW((PhaseLock{20, 20}.check({})), ConfigError);
  EXPECT_THROW((PhaseLock{-1, 0}.check({})), ConfigError);
}
