#include "imaging/link/assignment.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

#include "core/constants.hpp"

namespace twincell::imaging {

namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

/// Solver by shortest augmenting paths. Columns 0 .. m-1 are real; column m + i is row i's private column
/// "alone", at cost 0.
class Solver {
 public:
  Solver(std::size_t rows, std::size_t columns, std::span<const Edge> edges, std::size_t work)
      : n_(rows),
        m_(columns),
        edges_(edges),
        work_(work),
        first_(rows + 1),
        price_(rows + columns),
        row_of_(rows + columns, kNobody),
        edge_of_row_(rows, kAloneEdge),
        distance_(rows + columns, kInfinity),
        from_row_(rows + columns),
        from_edge_(rows + columns) {
    std::size_t e = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      first_[i] = e;
      while (e < edges.size() && edges[e].row == i) ++e;
    }
    first_[rows] = e;
  }

  Assignment solve() {
    Assignment result;
    result.column_of_row.assign(n_, Assignment::kAlone);
    result.margin.assign(n_, kInfinity);
    std::vector<std::uint32_t> left_over;
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (first_[i] == first_[i + 1]) continue;
      if (visited_ > work_)
        left_over.push_back(i);
      else
        insert(i);
    }
    for (const std::uint32_t i : left_over) take_cheapest_free(i);
    result.unsolved = left_over.size();
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (first_[i] == first_[i + 1]) continue;
      result.margin[i] = visited_ > work_ ? 0 : margin(i);
      if (edge_of_row_[i] != kAloneEdge) result.column_of_row[i] = edges_[edge_of_row_[i]].column;
    }
    count_networks(result);
    return result;
  }

 private:
  static constexpr std::size_t kAloneEdge = std::numeric_limits<std::size_t>::max();
  using Reached = std::pair<double, std::uint32_t>;

  [[nodiscard]] std::uint32_t alone(std::uint32_t row) const { return static_cast<std::uint32_t>(m_ + row); }
  [[nodiscard]] std::uint32_t column_of(std::uint32_t row) const {
    return edge_of_row_[row] == kAloneEdge ? alone(row) : edges_[edge_of_row_[row]].column;
  }
  [[nodiscard]] double cost_of(std::uint32_t row) const {
    return edge_of_row_[row] == kAloneEdge ? 0 : edges_[edge_of_row_[row]].cost;
  }

  void relax(std::uint32_t row, double offset, std::uint32_t forbidden) {
    auto reach = [&](std::uint32_t column, double cost, std::size_t edge) {
      const double d = offset + cost - price_[column];
      if (d >= distance_[column]) return;
      if (distance_[column] == kInfinity) touched_.push_back(column);
      distance_[column] = d;
      from_row_[column] = row;
      from_edge_[column] = edge;
      heap_.emplace(d, column);
    };
    for (std::size_t e = first_[row]; e < first_[row + 1]; ++e)
      if (edges_[e].column != forbidden) reach(edges_[e].column, edges_[e].cost, e);
    if (alone(row) != forbidden) reach(alone(row), 0, kAloneEdge);
    visited_ += first_[row + 1] - first_[row] + 1;
  }

  // Dijkstra's algorithm from a row to the nearest column that is free or equals `target`.
  std::uint32_t nearest_free(std::uint32_t row, std::uint32_t target, std::uint32_t forbidden) {
    heap_ = {};
    touched_.clear();
    settled_.clear();
    relax(row, 0, forbidden);
    while (!heap_.empty()) {
      const auto [d, column] = heap_.top();
      heap_.pop();
      if (d > distance_[column]) continue;
      if (row_of_[column] == kNobody || column == target) return column;
      settled_.push_back(column);
      const std::uint32_t next = row_of_[column];
      relax(next, d - (cost_of(next) - price_[column]), column);
    }
    return kNobody;  // not reached: a row's own column is always free for it or for a row before it
  }

  void forget() {
    for (const std::uint32_t c : touched_) distance_[c] = kInfinity;
  }

  void insert(std::uint32_t row) {
    std::uint32_t column = nearest_free(row, kNobody, kNobody);
    const double end = distance_[column];
    for (const std::uint32_t c : settled_) price_[c] += distance_[c] - end;
    while (true) {
      const std::uint32_t taker = from_row_[column];
      const std::uint32_t given_up = taker == row ? kNobody : column_of(taker);
      edge_of_row_[taker] = from_edge_[column];
      row_of_[column] = taker;
      if (taker == row) break;
      column = given_up;
    }
    forget();
  }

  void take_cheapest_free(std::uint32_t row) {
    std::size_t best = kAloneEdge;
    for (std::size_t e = first_[row]; e < first_[row + 1]; ++e)
      if (row_of_[edges_[e].column] == kNobody &&
          edges_[e].cost < (best == kAloneEdge ? 0 : edges_[best].cost))
        best = e;
    edge_of_row_[row] = best;
    row_of_[column_of(row)] = row;
  }

  // Cheapest augmenting path that gives the row another column, while its present column counts as free.
  double margin(std::uint32_t row) {
    const std::uint32_t own = column_of(row);
    const double here = cost_of(row) - price_[own];
    const std::uint32_t column = nearest_free(row, own, own);
    const double rise = column == kNobody ? kInfinity : distance_[column] - here;
    forget();
    return std::max(rise, 0.0);
  }

  void count_networks(Assignment& result) const {
    std::vector<std::uint32_t> parent(n_ + m_), rows(n_ + m_);
    std::iota(parent.begin(), parent.end(), 0U);
    auto root = [&](std::uint32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (const Edge& e : edges_) parent[root(e.row)] = root(static_cast<std::uint32_t>(n_ + e.column));
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (first_[i] == first_[i + 1]) continue;
      const std::uint32_t size = ++rows[root(i)];
      result.networks += size == 1 ? 1 : 0;
      result.largest_network = std::max<std::size_t>(result.largest_network, size);
    }
  }

  std::size_t n_, m_;
  std::span<const Edge> edges_;
  std::size_t work_, visited_ = 0;
  std::vector<std::size_t> first_;
  std::vector<double> price_;
  std::vector<std::uint32_t> row_of_;
  std::vector<std::size_t> edge_of_row_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> from_row_;
  std::vector<std::size_t> from_edge_;
  std::vector<std::uint32_t> touched_, settled_;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> heap_;
};

}  // namespace

void keep_cheapest(std::vector<Edge>& edges, std::size_t most) {
  if (edges.size() <= most) return;
  std::nth_element(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(most), edges.end(),
                   [](const Edge& a, const Edge& b) {
                     return a.cost < b.cost || (a.cost == b.cost && a.column < b.column);
                   });
  edges.resize(most);
}

Assignment assign(std::size_t rows, std::size_t columns, std::span<const Edge> edges, std::size_t work) {
  return Solver(rows, columns, edges, work).solve();
}

}  // namespace twincell::imaging
