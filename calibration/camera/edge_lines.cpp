#include "calibration/camera/edge_lines.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calibration/fit/outliers.hpp"
#include "core/median.hpp"

namespace twincell::calibration {

namespace {

/// An edge point in the edge's coordinates: u along, v across the edge; v increases towards the cell's
/// interior.
struct AlongEdge {
  double u, v;
};

/// v = offset + slope u.
struct EdgeLine {
  double slope = 0, offset = 0;
  std::size_t support = 0;
  [[nodiscard]] double distance(const AlongEdge& p) const { return p.v - offset - slope * p.u; }
};

/// Median and count of the outermost window of width kEdgeWindow_px that contains at least `need` of the
/// sorted values; {0, 0} if there is no such window.
std::pair<double, std::size_t> outermost(const std::vector<double>& sorted, std::size_t need) {
  for (std::size_t a = 0, b = 0; a < sorted.size(); ++a) {
    b = std::max(b, a);
    while (b < sorted.size() && sorted[b] <= sorted[a] + kEdgeWindow_px) ++b;
    if (b - a < need) continue;
    // The first window with enough points may contain only the outer half of the edge, so take the fullest
    // window that begins within one window width of it.
    std::size_t best = b - a, at = a;
    for (std::size_t c = a, e = b; c < sorted.size() && sorted[c] <= sorted[a] + kEdgeWindow_px; ++c) {
      while (e < sorted.size() && sorted[e] <= sorted[c] + kEdgeWindow_px) ++e;
      if (e - c > best) best = e - c, at = c;
    }
    return {sorted[at + best / 2], best};
  }
  return {0, 0};
}

/// Outermost line that at least `share` of the points follow, by a scan over slopes within +-steepest.
std::optional<EdgeLine> outermost_line(std::vector<AlongEdge> points, double steepest, double share) {
  constexpr std::size_t kMaxPoints = 400;  // used in the scan
  if (points.size() > kMaxPoints) {
    std::vector<AlongEdge> thinned;
    for (std::size_t i = 0; i < kMaxPoints; ++i) thinned.push_back(points[i * points.size() / kMaxPoints]);
    points = std::move(thinned);
  }
  const auto need =
      std::max<std::size_t>(4, static_cast<std::size_t>(share * static_cast<double>(points.size())));
  if (points.size() < need) return std::nullopt;
  double middle = 0, reach = 1;
  for (const AlongEdge& p : points) middle += p.u / static_cast<double>(points.size());
  for (const AlongEdge& p : points) reach = std::max(reach, std::abs(p.u - middle));
  const double step = 0.5 * kEdgeWindow_px / reach;
  EdgeLine best;
  std::vector<double> r(points.size());
  for (double slope = -steepest; slope <= steepest; slope += step) {
    for (std::size_t i = 0; i < points.size(); ++i) r[i] = points[i].v - slope * (points[i].u - middle);
    std::sort(r.begin(), r.end());
    const auto [offset, support] = outermost(r, need);
    // If two slopes have equal support, take the less steep line.
    if (support > best.support || (support == best.support && std::abs(slope) < std::abs(best.slope)))
      best = {slope, offset - slope * middle, support};
  }
  if (best.support < need) return std::nullopt;
  return best;
}

AlongEdge along_of(const imaging::PixelPoint& p, int side) {
  return side == 0   ? AlongEdge{p.y_px, p.x_px}
         : side == 1 ? AlongEdge{p.y_px, -p.x_px}
                     : AlongEdge{p.x_px, -p.y_px};
}

}  // namespace

std::vector<WallRow> rows_of_wall(const std::vector<std::vector<imaging::EdgePoint>>& frames, int side) {
  constexpr double kMaxSlope = 0.25;  // of a wall, px per px of its height
  std::vector<AlongEdge> all;
  for (const auto& frame : frames)
    for (const imaging::EdgePoint& p : frame) all.push_back(along_of(p.at, side));
  const auto line = outermost_line(all, kMaxSlope, 0.05);
  std::vector<WallRow> rows;
  if (!line) return rows;
  // Distortion curves the wall, so a parabola is fitted in a window that narrows with each round.
  Eigen::Vector3d bend(line->offset, line->slope, 0);
  double middle = 0;
  const auto distance = [&](const AlongEdge& p) {
    const double u = p.u - middle;
    return p.v - bend[0] - bend[1] * u - bend[2] * u * u;
  };
  double u_sum = 0;
  for (const AlongEdge& p : all) u_sum += p.u;
  middle = u_sum / static_cast<double>(all.size());
  bend[0] += bend[1] * middle;
  double window = 4 * kEdgeWindow_px;
  for (int round = 0; round < 6; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> r;
    for (const AlongEdge& p : all) {
      if (std::abs(distance(p)) > window) continue;
      const Eigen::Vector3d b(1, p.u - middle, (p.u - middle) * (p.u - middle));
      normal += b * b.transpose();
      right += p.v * b;
    }
    bend = normal.ldlt().solve(right);
    for (const AlongEdge& p : all)
      if (std::abs(distance(p)) <= window) r.push_back(distance(p));
    if (r.size() < 8) break;
    window = std::clamp(kWorstSigma * robust_spread(r), 0.05, window);
  }
  std::map<int, WallRow> sums;
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (const imaging::EdgePoint& p : frames[f]) {
      if (std::abs(distance(along_of(p.at, side))) > window) continue;
      WallRow& row = sums.try_emplace(static_cast<int>(p.at.y_px), WallRow{.at = {0, p.at.y_px}, .frames = 0})
                         .first->second;
      row.at.x_px += p.at.x_px;
      row.seen.push_back(f);
      ++row.frames;
    }
  for (auto& [y, row] : sums) {
    // Skip rows that are detected in less than a quarter of the frames: beads hide them most of the time.
    if (row.frames * 4 < static_cast<double>(frames.size())) continue;
    row.at.x_px /= row.frames;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<double> plate_slope(const std::vector<std::vector<imaging::EdgePoint>>& plate,
                                  std::size_t stride) {
  constexpr double kMaxSlope = 0.1;           // of the plate, px per px of its width
  constexpr double kMinShareOfPoints = 0.03;  // that follow the line
  std::vector<double> slopes;
  for (std::size_t f = 0; f < plate.size(); f += stride) {
    std::vector<AlongEdge> points;
    for (const imaging::EdgePoint& p : plate[f]) points.push_back(along_of(p.at, 2));
    if (const auto line = outermost_line(points, kMaxSlope, kMinShareOfPoints)) slopes.push_back(line->slope);
  }
  if (slopes.empty()) return std::nullopt;
  return upper_median(slopes);
}

std::vector<imaging::PixelPoint> on_plate(const std::vector<imaging::EdgePoint>& frame, double slope,
                                          double window) {
  std::vector<double> r;
  for (const imaging::EdgePoint& p : frame) r.push_back(along_of(p.at, 2).v - slope * p.at.x_px);
  std::vector<double> sorted = r;
  std::sort(sorted.begin(), sorted.end());
  const auto [offset, support] = outermost(
      sorted, std::max<std::size_t>(3, static_cast<std::size_t>(0.03 * static_cast<double>(r.size()))));
  std::vector<imaging::PixelPoint> points;
  if (support == 0) return points;
  for (std::size_t i = 0; i < r.size(); ++i)
    if (std::abs(r[i] - offset) < window) points.push_back(frame[i].at);
  return points;
}

}  // namespace twincell::calibration
