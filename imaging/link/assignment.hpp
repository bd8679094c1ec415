#pragma once
/// \file
/// Minimum-cost assignment in a sparse network: which row takes which column, and the cost margin to the
/// second-best assignment.
///
/// Method: shortest augmenting paths with column prices (Jonker & Volgenant, Computing 38, 325 (1987)), found
/// by Dijkstra's algorithm over the existing edges. A path never leaves the connected sub-network in which it
/// starts. The sub-networks are therefore solved one by one without being built explicitly.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace twincell::imaging {

/// Cost of assigning a row (a track) to a column (a detection).
struct Edge {
  std::uint32_t row = 0, column = 0;
  double cost = 0;  ///< finite; below 0: cheaper than leaving both unassigned
};

/// Keeps the `most` cheapest edges, in any order; of edges of equal cost those with the lower column.
void keep_cheapest(std::vector<Edge>& edges, std::size_t most);

/// The minimum-cost assignment.
struct Assignment {
  static constexpr std::int64_t kAlone = -1;
  std::vector<std::int64_t> column_of_row;  ///< kAlone: unassigned
  /// Rise of the total cost if the row must take another column or stay unassigned. Infinity for rows without
  /// edges. 0 for rows whose margin was not computed because the work bound was exceeded, which includes all
  /// rows left to the fallback.
  std::vector<double> margin;
  std::size_t networks = 0;         ///< connected sub-networks with at least one edge
  std::size_t largest_network = 0;  ///< rows in the largest
  std::size_t unsolved = 0;         ///< rows left to the fallback
};

/// Assigns each row to one column, or leaves it unassigned at cost 0, so that each column is taken at most
/// once and the total cost is minimal. `edges` must be sorted by row; a row and a column share at most one
/// edge.
/// \param work bound on the number of edges examined. Beyond it each remaining row takes the cheapest column
///     that is still free (counted in `unsolved`), so the run time stays linear in the number of edges
Assignment assign(std::size_t rows, std::size_t columns, std::span<const Edge> edges,
                  std::size_t work = std::size_t{1} << 23);

}  // namespace twincell::imaging
