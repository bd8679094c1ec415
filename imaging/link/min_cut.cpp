#include "imaging/link/min_cut.hpp"

#include <algorithm>
#include <limits>

namespace twincell::imaging {

// Boost.Graph's boykov_kolmogorov_max_flow was tried on an adjacency_list. On 600 random grids of 49 and 324
// nodes, each joined to six neighbours, with capacities as doubles and as scaled integers, it chose the same.
// It took 3.4 times the instructions at 49 nodes and 1.6 times at 324 (callgrind), because its graph is
// allocated node by node, and a fusion has few nodes.

namespace {
constexpr double kNothing = 1e-9;  // smaller residual capacities are rounding errors and count as 0
}

// Node n is the source and node n + 1 the sink. Nodes on the side of the source stay.
MinCut::MinCut(std::size_t nodes) : nodes_(nodes), first_(nodes + 2, -1) {}

void MinCut::add(std::size_t from, std::size_t to, double capacity) {
  arcs_.push_back({to, first_[from], capacity});
  first_[from] = static_cast<int>(arcs_.size()) - 1;
  arcs_.push_back({from, first_[to], 0});
  first_[to] = static_cast<int>(arcs_.size()) - 1;
}

void MinCut::move(std::size_t node, double cost) {
  if (cost > 0)
    add(nodes_, node, cost);
  else if (cost < 0)
    add(node, nodes_ + 1, -cost);
}

void MinCut::stay_and_move(std::size_t stays, std::size_t moves, double cost) {
  if (cost > 0) add(stays, moves, cost);
}

bool MinCut::layer() {
  level_.assign(first_.size(), -1);
  std::vector<std::size_t> queue = {nodes_};
  level_[nodes_] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i)
    for (int e = first_[queue[i]]; e >= 0; e = arcs_[static_cast<std::size_t>(e)].next) {
      const Arc& arc = arcs_[static_cast<std::size_t>(e)];
      if (arc.left <= kNothing || level_[arc.to] >= 0) continue;
      level_[arc.to] = level_[queue[i]] + 1;
      queue.push_back(arc.to);
    }
  return level_[nodes_ + 1] >= 0;
}

double MinCut::push(std::size_t node, double most) {
  if (node == nodes_ + 1) return most;
  for (int& e = at_[node]; e >= 0; e = arcs_[static_cast<std::size_t>(e)].next) {
    Arc& arc = arcs_[static_cast<std::size_t>(e)];
    if (arc.left <= kNothing || level_[arc.to] != level_[node] + 1) continue;
    const double flow = push(arc.to, std::min(most, arc.left));
    if (flow <= 0) continue;
    arc.left -= flow;
    arcs_[static_cast<std::size_t>(e ^ 1)].left += flow;
    return flow;
  }
  return 0;
}

std::vector<std::uint8_t> MinCut::solve() {
  while (layer()) {
    at_ = first_;
    while (push(nodes_, std::numeric_limits<double>::max()) > 0) {
    }
  }
  std::vector<std::uint8_t> moves(nodes_);
  for (std::size_t v = 0; v < nodes_; ++v) moves[v] = level_[v] < 0 ? 1 : 0;
  return moves;
}

}  // namespace twincell::imaging
