#pragma once
/// \file
/// Minimum-cost assignment in a sparse network: who goes with whom, and how near the runner-up is.
///
/// Shortest augmenting paths with column prices (Jonker & Volgenant, Computing 38, 325 (1987)), found by
/// Dijkstra's method over the edges that exist. A path never leaves the connected sub-network it began in, so
/// the sub-networks are solved one by one without being formed.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace twincell {

/// A row (a track) may go with a column (a detection) at this cost.
struct Edge {
  std::uint32_t row = 0, column = 0;
  double cost = 0;  ///< finite; below 0: better than leaving both alone
};

/// The cheapest assignment.
struct Assignment {
  static constexpr std::int64_t kAlone = -1;
  std::vector<std::int64_t> column_of_row;  ///< kAlone: no column
  /// By how much the total would rise if the row had to take another column or stay alone; infinity for rows
  /// without edges and rows that the bound on work left to the fallback have 0.
  std::vector<double> margin;
  std::size_t networks = 0;         ///< connected sub-networks with at least one edge
  std::size_t largest_network = 0;  ///< rows in the largest
  std::size_t unsolved = 0;         ///< rows given to the fallback
};

/// Every row takes one column or stays alone at cost 0, every column is taken at most once, and the sum of
/// costs is least. `edges` are sorted by row; a row and column meet in at most one edge.
/// \param work bound on the edges looked at. Beyond it the remaining rows take the cheapest column that is
///     still free (counted in `unsolved`), so that time stays linear in the number of edges
Assignment assign(std::size_t rows, std::size_t columns, std::span<const Edge> edges,
                  std::size_t work = std::size_t{1} << 23);

}  // namespace twincell
