#pragma once
/// \file
/// Least cut between a source and a sink, and with it the best choice of many twofold choices at once.
///
/// A sum of terms that cost something if one node stays and another moves, and of terms of single nodes, is
/// the cost of a cut; the least is found by shortest augmenting paths in layers (Dinic, Soviet Math. Doklady
/// 11, 1277 (1970)).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace twincell {

/// Nodes that stay or move.
class MinCut {
 public:
  explicit MinCut(std::size_t nodes);
  /// Moving costs `cost` more than staying; below 0: less.
  void move(std::size_t node, double cost);
  /// \param cost >= 0, of one staying while the other moves
  void stay_and_move(std::size_t stays, std::size_t moves, double cost);
  /// Who moves in the cheapest choice; of equals the one in which most move. Call once.
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

}  // namespace twincell
