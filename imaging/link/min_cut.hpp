#pragma once
/// \file
/// Minimum cut between a source and a sink; it finds the jointly optimal choice for many binary variables.
///
/// A sum of single-node terms and of pair terms that cost something if one node stays and the other moves
/// equals the capacity of a cut. The minimum is found by maximum flow with shortest augmenting paths in
/// layers (Dinic, Soviet Math. Doklady 11, 1277 (1970)).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace twincell::imaging {

/// Binary choice for each node: stay or move. Costs are in any one unit.
class MinCut {
 public:
  explicit MinCut(std::size_t nodes);
  /// Adds a term by which moving costs `cost` more than staying; below 0: less.
  void move(std::size_t node, double cost);
  /// Adds a term that applies if node `stays` stays while node `moves` moves.
  /// \param cost >= 0
  void stay_and_move(std::size_t stays, std::size_t moves, double cost);
  /// Returns 1 for each node that moves in the cheapest choice. Among equal choices it returns the one in
  /// which most nodes move. Call once.
  std::vector<std::uint8_t> solve();

 private:
  struct Arc {
    std::size_t to;
    int next;
    double left;
  };
  void add(std::size_t from, std::size_t to, double capacity);
  bool layer();
  double push(std::size_t node, double most);

  std::size_t nodes_;
  std::vector<int> first_, at_, level_;
  std::vector<Arc> arcs_;
};

}  // namespace twincell::imaging
