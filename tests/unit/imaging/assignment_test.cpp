// The sparse assignment against enumeration of all possible assignments.
#include "imaging/link/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

namespace twincell::assignment_test {

using namespace imaging;

namespace {

/// Minimum cost over all assignments of each row to a column or to no column, with one edge of one row
/// forbidden.
double least_sum(const std::vector<Edge>& edges, std::size_t rows, std::size_t row, std::vector<bool>& taken,
                 std::size_t forbidden_row, std::int64_t forbidden_column) {
  if (row == rows) return 0;
  const bool may_stay = row != forbidden_row || forbidden_column >= 0;
  double least = may_stay ? least_sum(edges, rows, row + 1, taken, forbidden_row, forbidden_column) : 1e300;
  for (const Edge& e : edges) {
    if (e.row != row || taken[e.column]) continue;
    if (row == forbidden_row && e.column == forbidden_column) continue;
    taken[e.column] = true;
    least = std::min(least, e.cost + least_sum(edges, rows, row + 1, taken, forbidden_row, forbidden_column));
    taken[e.column] = false;
  }
  return least;
}

std::vector<Edge> random_edges(std::mt19937_64& generator, std::size_t rows, std::size_t columns,
                               double share) {
  std::uniform_real_distribution<double> cost(-3, 1), chance(0, 1);
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j)
      if (chance(generator) < share) edges.push_back({i, j, cost(generator)});
  return edges;
}

double sum_of(const std::vector<Edge>& edges, const Assignment& a) {
  double sum = 0;
  for (const Edge& e : edges)
    if (a.column_of_row[e.row] == static_cast<std::int64_t>(e.column)) sum += e.cost;
  return sum;
}

}  // namespace

TEST(Assignment, SumAndMarginsAreThoseOfAllAssignments) {
  std::mt19937_64 generator(1);
  double worst = 0, worst_margin = 0;
  std::size_t margins = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t rows = 1 + static_cast<std::size_t>(trial) % 6,
                      columns = 1 + static_cast<std::size_t>(trial) % 5;
    const auto edges = random_edges(generator, rows, columns, 0.6);
    const Assignment a = assign(rows, columns, edges);
    std::vector<bool> taken(columns, false);
    const double least = least_sum(edges, rows, 0, taken, rows, 0);
    worst = std::max(worst, std::abs(sum_of(edges, a) - least));
    std::vector<std::int64_t> used;
    for (std::size_t i = 0; i < rows; ++i) {
      if (a.column_of_row[i] >= 0) used.push_back(a.column_of_row[i]);
      if (!std::isfinite(a.margin[i])) continue;
      const double without = least_sum(edges, rows, 0, taken, i, a.column_of_row[i]);
      if (without > 1e200) continue;
      worst_margin = std::max(worst_margin, std::abs(a.margin[i] - (without - least)));
      ++margins;
    }
    std::sort(used.begin(), used.end());
    EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end());
    EXPECT_EQ(a.unsolved, 0U);
  }
  std::cout << "largest error of a sum " << worst << ", of " << margins << " margins " << worst_margin
            << '\n';
  EXPECT_GT(margins, 500U);
  EXPECT_LE(worst, 1e-12);
  EXPECT_LE(worst_margin, 1e-12);
}

TEST(Assignment, NetworksAreCounted) {
  // Rows 0 and 1 compete for column 0; row 2 is independent; row 3 has no edge.
  const std::vector<Edge> edges = {{0, 0, -1}, {1, 0, -2}, {1, 1, -1.5}, {2, 2, 0.5}};
  const Assignment a = assign(4, 3, edges);
  EXPECT_EQ(a.column_of_row, (std::vector<std::int64_t>{0, 1, Assignment::kAlone, Assignment::kAlone}));
  EXPECT_EQ(a.networks, 2U);
  EXPECT_EQ(a.largest_network, 2U);
  EXPECT_NEAR(a.margin[0], 0.5, 1e-15);  // 1 alone on column 0
  EXPECT_NEAR(a.margin[2], 0.5, 1e-15);
  EXPECT_TRUE(std::isinf(a.margin[3]));
}

TEST(Assignment, TheBoundOnWorkHolds) {
  std::mt19937_64 generator(2);
  const auto edges = random_edges(generator, 300, 300, 0.5);
  const Assignment whole = assign(300, 300, edges), bounded = assign(300, 300, edges, 20000);
  EXPECT_EQ(whole.unsolved, 0U);
  EXPECT_GT(bounded.unsolved, 0U);
  EXPECT_LE(sum_of(edges, whole), sum_of(edges, bounded));
  std::vector<std::int64_t> used;
  for (std::size_t i = 0; i < 300; ++i)
    if (bounded.column_of_row[i] >= 0) used.push_back(bounded.column_of_row[i]);
  std::sort(used.begin(), used.end());
  EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end()) << "still each column once";
  EXPECT_EQ(assign(0, 0, {}).column_of_row.size(), 0U);
}

}  // namespace twincell::assignment_test
