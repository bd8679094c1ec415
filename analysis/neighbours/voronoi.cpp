#include "analysis/neighbours/voronoi.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/cancellation.hpp"

namespace twincell::analysis {
namespace {

/// Remaining segment of the bisector of a bond: points bond/2 + s m, low <= s <= high, with m the bond
/// rotated by 90 degrees to its left.
struct Segment {
  double low, high;
  bool low_on_rim = true, high_on_rim = true;

  [[nodiscard]] double length(double bond) const { return std::max(0.0, high - low) * bond; }
};

/// Clips the bisector of bond `entry` of `bead` to the shared edge. An empty segment if there is no shared
/// edge.
Segment shared_edge(const Neighbours& near, std::size_t bead, std::size_t entry, double radius) {
  const double bx = near.bond[entry].x(), bz = near.bond[entry].z();
  const double d2 = bx * bx + bz * bz;
  const double rim2 = radius * radius / d2 - 0.25;
  // Coincident beads have no bisector. Beads too far apart have no point of it within `radius`.
  if (d2 == 0 || rim2 <= 0) return {0, 0};
  const double rim = std::sqrt(rim2);
  Segment segment{-rim, rim};
  for (std::size_t k = near.first[bead]; k < near.first[bead + 1]; ++k) {
    if (k == entry) continue;
    const double kx = near.bond[k].x(), kz = near.bond[k].z();
    // Points nearer to the bead than to k satisfy  p . k <= k^2/2  with  p = b/2 + s m,  m = (-bz, bx).
    const double slope = kz * bx - kx * bz;
    const double room = 0.5 * (kx * kx + kz * kz - kx * bx - kz * bz);
    if (slope > 0) {
      if (room < segment.high * slope) {
        segment.high = room / slope;
        segment.high_on_rim = false;
      }
    } else if (slope < 0) {
      if (room < segment.low * slope) {
        segment.low = room / slope;
        segment.low_on_rim = false;
      }
    } else if (room < 0) {
      return {0, 0};  // k is between the two beads
    }
    if (segment.low >= segment.high) return {0, 0};
  }
  return segment;
}

}  // namespace

VoronoiCells voronoi_cells(const Frame& frame, const Box& box, double radius) {
  assert(radius > 0);
  const Neighbours near = find_neighbours(frame, box, 2 * radius);
  const std::size_t n = near.first.size() - 1;
  struct Edge {
    double length = 0;
    bool open_left = false, open_right = false;
  };
  std::vector<Edge> edges(near.index.size());

  VoronoiCells cells;
  cells.neighbours.cutoff = 2 * radius;
  cells.neighbours.first.assign(n + 1, 0);
  cells.enclosed.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    throw_if_cancelled();
    bool rim = false;
    for (std::size_t e = near.first[i]; e < near.first[i + 1]; ++e) {
      const std::size_t j = near.index[e];
      if (j > i) {
        const Segment segment = shared_edge(near, i, e, radius);
        edges[e] = {segment.length(std::hypot(near.bond[e].x(), near.bond[e].z())), segment.high_on_rim,
                    segment.low_on_rim};
      } else {
        // The edge of each pair is computed once, so that the neighbour relation is symmetric despite
        // rounding.
        const auto begin = near.index.begin() + static_cast<std::ptrdiff_t>(near.first[j]);
        const auto end = near.index.begin() + static_cast<std::ptrdiff_t>(near.first[j + 1]);
        const Edge& twin =
            edges[static_cast<std::size_t>(std::lower_bound(begin, end, i) - near.index.begin())];
        edges[e] = {twin.length, twin.open_right, twin.open_left};
      }
      if (edges[e].length <= kShortestEdge) continue;
      cells.neighbours.index.push_back(j);
      cells.neighbours.bond.push_back(near.bond[e]);
      cells.edge.push_back(edges[e].length);
      cells.open_left.push_back(edges[e].open_left ? 1 : 0);
      rim = rim || edges[e].open_left || edges[e].open_right;
    }
    cells.neighbours.first[i + 1] = cells.neighbours.index.size();
    cells.enclosed[i] = !rim && cells.neighbours.count(i) >= 3 ? 1 : 0;
  }
  return cells;
}

}  // namespace twincell::analysis
