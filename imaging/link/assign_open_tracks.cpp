#include "imaging/link/assign_open_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "imaging/link/assignment.hpp"
#include "imaging/link/link_costs.hpp"

namespace twincell::imaging {

namespace {

/// Closest approach of two beads that move along straight lines at constant velocity.
double closest(PixelPoint from_a, PixelPoint to_a, PixelPoint from_b, PixelPoint to_b) {
  const PixelPoint before = from_a - from_b, change = to_a - to_b - before;
  const double c2 = square(change), dot = before.x_px * change.x_px + before.y_px * change.y_px;
  return std::sqrt(square(before + (c2 > 0 ? std::clamp(-dot / c2, 0.0, 1.0) : 0) * change));
}

/// Exchanges two links on which one disc would pass through the other, if the exchanged links are allowed and
/// not too expensive. Discs of one layer cannot pass through each other, but a sum of single costs does not
/// express that.
void exchange_crossing_links(Assignment& best, const std::vector<Edge>& edges,
                             const std::vector<PixelPoint>& from, const std::vector<PixelPoint>& to,
                             double d) {
  auto edges_of = [&](std::size_t row) {
    return std::equal_range(edges.begin(), edges.end(), Edge{static_cast<std::uint32_t>(row), 0, 0},
                            [](const Edge& a, const Edge& b) { return a.row < b.row; });
  };
  auto cost_of = [&](std::size_t row, std::int64_t column) {
    const auto [begin, end] = edges_of(row);
    const auto e = std::find_if(begin, end, [&](const Edge& a) { return a.column == column; });
    return e == end ? std::numeric_limits<double>::infinity() : e->cost;
  };
  std::vector<std::int64_t> row_of(to.size(), Assignment::kAlone);
  for (std::size_t i = 0; i < from.size(); ++i)
    if (best.column_of_row[i] >= 0)
      row_of[static_cast<std::size_t>(best.column_of_row[i])] = static_cast<std::int64_t>(i);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::int64_t& mine = best.column_of_row[i];
    if (mine < 0) continue;
    const auto [begin, end] = edges_of(i);
    for (auto e = begin; e != end; ++e) {
      if (row_of[e->column] < 0 || e->column == mine) continue;
      const auto j = static_cast<std::size_t>(row_of[e->column]);
      std::int64_t& theirs = best.column_of_row[j];
      const PixelPoint a = to[static_cast<std::size_t>(mine)], b = to[static_cast<std::size_t>(theirs)];
      if (closest(from[i], a, from[j], b) > kLinkCosts.passing_through * d ||
          closest(from[i], b, from[j], a) < kLinkCosts.passing_clear * d)
        continue;
      if (e->cost + cost_of(j, mine) - cost_of(i, mine) - cost_of(j, theirs) > kLinkCosts.exchange_cost_limit)
        continue;
      std::swap(mine, theirs);
      std::swap(row_of[static_cast<std::size_t>(mine)], row_of[static_cast<std::size_t>(theirs)]);
      break;
    }
  }
}

/// The network of the open tracks and the free detections that they may take.
struct Network {
  std::vector<std::int32_t> rows, columns;  // tracks and detections
  std::vector<Edge> edges;                  // between indices of rows and columns
};

/// Possible positions of a track, each with the cost of assuming it.
using Guesses = std::vector<std::pair<PixelPoint, double>>;

Guesses guesses_of(const FrameMatch& m, std::size_t t) {
  constexpr double kLessLikely = 0.7;  // log-odds
  const Track& track = m.tracks[t];
  Guesses guesses = {{m.expected[t], 0}};
  if (std::isfinite(m.neighbour_correction[t].x_px)) {
    guesses.front().second = kLessLikely;
    guesses.emplace_back(m.expected_no_floor[t] + m.neighbour_correction[t], 0);
  }
  if (track.missed == 0) {
    guesses.emplace_back(track.place + m.time.interval * m.before.step, kLessLikely);
    guesses.emplace_back(m.ballistic[t], 0);
  }
  return guesses;
}

/// Edges from a track to the free detections that are cheaper than staying alone; the cheapest if they are
/// many.
void find_edges(const FrameMatch& m, std::size_t t, std::uint32_t row, std::vector<Edge>& edges) {
  const double d = m.options.diameter_px;
  const double alone =
      cost(m.options.range_diameters * m.options.range_diameters, kLinkCosts.prediction_width);
  const Track& track = m.tracks[t];
  const double width = kLinkCosts.prediction_width * (1 + track.missed);
  const double range = m.options.range_diameters * (1 + 0.5 * track.missed) * d;
  const Guesses guesses = guesses_of(m, t);
  edges.clear();
  m.detections.within(m.expected[t], range, [&](std::size_t k, double) {
    if (m.track_of[k] >= 0) return;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [guess, extra] : guesses)
      least = std::min(least, cost(square(m.detections[k] - guess) / (d * d), width) + extra);
    if (m.changes_type(t, k)) least += kLinkCosts.type_change_cost;
    if (least < alone) edges.push_back({row, static_cast<std::uint32_t>(k), least - alone});
  });
  keep_cheapest(edges, kLinkCosts.max_edges);
}

Network network_of(const FrameMatch& m) {
  Network net;
  std::vector<Edge> own;
  std::vector<std::int32_t> column_of(m.detections.size(), -1);
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    if (m.detection_of[t] >= 0) continue;
    find_edges(m, t, static_cast<std::uint32_t>(net.rows.size()), own);
    if (own.empty()) continue;
    for (Edge& e : own) {
      std::int32_t& column = column_of[e.column];
      if (column < 0) {
        column = static_cast<std::int32_t>(net.columns.size());
        net.columns.push_back(static_cast<std::int32_t>(e.column));
      }
      e.column = static_cast<std::uint32_t>(column);
      net.edges.push_back(e);
    }
    net.rows.push_back(static_cast<std::int32_t>(t));
  }
  return net;
}

}  // namespace

void assign_open_tracks(FrameMatch& m) {
  const Network net = network_of(m);
  if (net.rows.empty()) return;
  Assignment best = assign(net.rows.size(), net.columns.size(), net.edges);
  m.report.edges = static_cast<std::int64_t>(net.edges.size());
  m.report.networks = static_cast<std::int64_t>(best.networks);
  m.report.largest_network = static_cast<std::int64_t>(best.largest_network);
  m.report.unsolved = static_cast<std::int64_t>(best.unsolved);
  std::vector<PixelPoint> from, to;
  for (const std::int32_t t : net.rows) from.push_back(m.tracks[static_cast<std::size_t>(t)].place);
  for (const std::int32_t k : net.columns) to.push_back(m.detections[static_cast<std::size_t>(k)]);
  exchange_crossing_links(best, net.edges, from, to, m.options.diameter_px);
  const double least_margin = std::log(kAmbiguousOdds);
  for (std::size_t i = 0; i < net.rows.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::int32_t k = net.columns[static_cast<std::size_t>(best.column_of_row[i])];
    m.detection_of[static_cast<std::size_t>(net.rows[i])] = k;
    m.track_of[static_cast<std::size_t>(k)] = net.rows[i];
    if (best.margin[i] < least_margin) m.mark_ambiguous(static_cast<std::size_t>(k));
  }
}

}  // namespace twincell::imaging
