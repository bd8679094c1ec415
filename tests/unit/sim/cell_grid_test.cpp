// Near pairs from the cell grid against a search over all pairs: the same pairs, each once, for all sizes.

#include "sim/system/cell_grid.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

namespace twincell::sim::cell_grid_test {
namespace {

struct Case {
  std::string name;
  int dimension;
  std::array<double, 3> period;
  double extent;  ///< of the cube (3D) or square (2D) that contains the beads; it may exceed the period
  std::vector<double> radii;
};

std::vector<Bead> scattered(const Case& c, std::size_t n, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place(-c.extent, c.extent);
  std::vector<Bead> beads(n);
  for (std::size_t i = 0; i < n; ++i) {
    beads[i].x = place(engine);
    if (c.dimension == 3) beads[i].y = place(engine);
    beads[i].z = place(engine);
    beads[i].radius = c.radii[i % c.radii.size()];
  }
  return beads;
}

struct Found {
  double gap;
  Vec3 shift;
};
using Pairs = std::map<std::pair<std::int32_t, std::int32_t>, Found>;

Pairs by_cells(const std::vector<Bead>& beads, const Case& c, double margin) {
  Pairs found;
  for_each_near_pair(
      beads, c.dimension, c.period, margin,
      [&](std::int32_t i, std::int32_t j, double gap, const Vec3& shift) {
        EXPECT_LT(i, j);
        EXPECT_TRUE(found.try_emplace({i, j}, Found{gap, shift}).second) << i << " " << j << " came twice";
      });
  return found;
}

/// Searches all pairs and all their periodic images.
Pairs by_looking_at_all(const std::vector<Bead>& beads, const Case& c, double margin) {
  Pairs found;
  for (std::size_t i = 0; i < beads.size(); ++i)
    for (std::size_t j = i + 1; j < beads.size(); ++j) {
      const Vec3 apart = centre_of(beads[i]) - centre_of(beads[j]);
      const auto images = [&](std::size_t a) {
        return c.period[a] > 0 ? static_cast<int>(std::ceil(2 * c.extent / c.period[a])) : 0;
      };
      Found nearest{HUGE_VAL, Vec3::Zero()};
      for (int kx = -images(0); kx <= images(0); ++kx)
        for (int ky = -images(1); ky <= images(1); ++ky)
          for (int kz = -images(2); kz <= images(2); ++kz) {
            const Vec3 shift(kx * c.period[0], ky * c.period[1], kz * c.period[2]);
            const double gap = (apart + shift).norm() - (beads[i].radius + beads[j].radius);
            if (gap < nearest.gap) nearest = {gap, shift};
          }
      if (nearest.gap < margin)
        found.try_emplace({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}, nearest);
    }
  return found;
}

TEST(CellGrid, FindsWhatLookingAtAllFinds) {
  std::vector<Case> cases;
  const std::vector<std::pair<const char*, std::vector<double>>> kinds = {
      {"equal", {0.5}},
      {"one per cent", {0.495, 0.5, 0.505}},
      {"1 : 100", {1.5, 0.5, 0.2, 0.06, 0.021, 0.015}}};
  for (const auto& [sizes, radii] : kinds) {
    cases.push_back({fmt::format("2D, {}", sizes), 2, {0, 0, 0}, 9, radii});
    cases.push_back({fmt::format("2D, period x, {}", sizes), 2, {7.3, 0, 0}, 9, radii});
    cases.push_back({fmt::format("2D, periods x and z, {}", sizes), 2, {7.3, 0, 11}, 13, radii});
    cases.push_back({fmt::format("3D, {}", sizes), 3, {0, 0, 0}, 4, radii});
    cases.push_back({fmt::format("3D, periods x and y, {}", sizes), 3, {7.3, 7, 0}, 6, radii});
    cases.push_back({fmt::format("3D, all periods, {}", sizes), 3, {7, 7.5, 8}, 6, radii});
  }
  // With two cells or one cell per period the neighbours on both sides are the same cell.
  cases.push_back({"3D, narrow", 3, {2.6, 2.6, 0}, 4, {0.5}});
  std::size_t all = 0;
  for (const Case& c : cases)
    for (const double margin : {0.0, 0.25})
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto beads = scattered(c, 200, seed);
        const Pairs cells = by_cells(beads, c, margin), looked = by_looking_at_all(beads, c, margin);
        ASSERT_EQ(cells.size(), looked.size()) << c.name << ", margin " << margin;
        for (const auto& [pair, found] : looked) {
          const auto at = cells.find(pair);
          ASSERT_NE(at, cells.end()) << c.name << ": " << pair.first << " " << pair.second;
          EXPECT_NEAR(at->second.gap, found.gap, 1e-12);
          EXPECT_LT((at->second.shift - found.shift).norm(), 1e-12);
        }
        all += looked.size();
      }
  std::printf("%zu pairs in %zu cells\n", all, cases.size());
}

TEST(CellGrid, TouchingAtTheEdgeOfACellCounts) {  // a gap of rounding size, for any position of the lattice
  for (const double from : {0.0, 0.3, 1e4, 1e6})
    for (const double gap : {-1e-9, 1e-9}) {
      std::vector<Bead> beads(50);
      for (std::size_t i = 0; i < beads.size(); ++i)
        beads[i].x = from + static_cast<double>(i) * (1.25 + gap);
      const Case c{"row", 2, {0, 0, 0}, 0, {0.5}};
      EXPECT_EQ(by_cells(beads, c, 0.25).size(), gap < 0 ? 49U : 0U) << from;
    }
}

TEST(CellGrid, FarAndLostBeadsCostNothing) {
  const Case c{"lost", 2, {10, 0, 0}, 9, {0.5}};
  auto beads = scattered(c, 200, 4);
  const std::size_t usual = by_cells(beads, c, 0.25).size();
  Bead far;
  far.z = 1e300;
  beads.push_back(far);
  far.z = -1e12;
  beads.push_back(far);
  far.x = 0.9;
  beads.push_back(far);
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    Bead lost;
    lost.x = none;
    beads.push_back(lost);
    lost.x = 3;
    lost.z = none;
    beads.push_back(lost);
  }
  const Pairs found = by_cells(beads, c, 0.25);
  EXPECT_EQ(found.size(), usual + 1);
  EXPECT_TRUE(found.contains({201, 202}));  // two beads far from the others that touch each other
  EXPECT_EQ(by_cells({}, c, 0.25).size(), 0U);
}

TEST(CellGrid, LargeBeadsDoNotMakeSmallOnesMany) {  // counts candidates per bead, not pairs per bead
  const auto candidates = [](std::size_t n) {
    const double side = std::sqrt(static_cast<double>(n));
    std::vector<double> radii(n, 0.5);
    radii.push_back(50);
    CellGrid grid(radii, 0.1, 2, {0, 0, 0});
    grid.insert(static_cast<std::int32_t>(n), Vec3::Zero(), 50);
    std::mt19937_64 engine(7);
    std::uniform_real_distribution<double> place(0, side);
    std::size_t visited = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 r(place(engine), 0, place(engine));
      grid.around(r, 0.5, [&](std::int32_t) { ++visited; });
      grid.insert(static_cast<std::int32_t>(i), r, 0.5);
    }
    return static_cast<double>(visited) / static_cast<double>(n);
  };
  const double few = candidates(2000), many = candidates(32000);
  std::printf("candidates a bead beside one a hundred times larger: %.2f of 2000, %.2f of 32000\n", few,
              many);
  EXPECT_LT(many, 12);
  EXPECT_LT(many, 1.2 * few);
}

}  // namespace
}  // namespace twincell::sim::cell_grid_test
