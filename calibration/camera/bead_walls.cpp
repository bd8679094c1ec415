#include "calibration/camera/bead_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "trajectory/plate.hpp"

namespace twincell::calibration {
namespace {

constexpr double kSliceHeight = 0.5;  // sigma
constexpr std::size_t kMinBeadsOfSlice = 20;
constexpr double kInside = 0.05;  // sigma: beads farther inside do not touch the wall

/// Height and outermost surface position of a slice.
struct OutermostPlace {
  DataPoint point;
  double trail;  ///< distance of the median of the beads within kInside, sigma
};

/// Of each slice. \param sign -1 for the left wall, +1 for the right wall
std::vector<OutermostPlace> outermost_places(
    const std::map<long, std::vector<std::pair<double, double>>>& slices, double sign) {
  std::vector<OutermostPlace> points;
  for (auto [slice, beads] : slices) {
    if (beads.size() < kMinBeadsOfSlice) continue;
    std::sort(beads.begin(), beads.end(),
              [&](const auto& a, const auto& b) { return sign * a.second > sign * b.second; });
    const std::size_t n = std::max<std::size_t>(3, beads.size() / 100);
    DataPoint outermost;
    for (std::size_t i = 0; i < n; ++i) {
      outermost.x += beads[i].first / static_cast<double>(n);
      outermost.y += beads[i].second / static_cast<double>(n);
    }
    std::vector<double> near;  // what noise carries outwards, and what the gaps of a gas keep inside
    for (const auto& [z, x] : beads)
      if (std::abs(x - outermost.y) < kInside) near.push_back(x);
    points.push_back({outermost, near.empty() ? 0 : std::abs(outermost.y - upper_median(std::move(near)))});
  }
  return points;
}

/// A straight wall, and what is unknown about whether beads touch it.
struct WallLine {
  CurveFit fit;
  double trail;  ///< mean over the slices, sigma
  std::size_t slices;
};

/// The line x = a + b z through the slices whose beads touch the wall. In a crystal only every other row
/// does: slices inside of the line are left out, until those that are left agree.
WallLine wall_line(std::vector<OutermostPlace> places, double sign) {
  for (;;) {
    std::vector<DataPoint> points;
    double trail = 0;
    for (const OutermostPlace& p : places) {
      points.push_back(p.point);
      trail += p.trail / static_cast<double>(places.size());
    }
    CurveFit fit = fit_curve(law_named("line"), points);
    const auto inside = [&](const OutermostPlace& p) {
      return sign * (fit.fit.values[0] + fit.fit.values[1] * p.point.x - p.point.y);
    };
    double squares = 0;
    for (const OutermostPlace& p : places) squares += inside(p) * inside(p);
    const double most = std::max(kInside, 0.5 * std::sqrt(squares / static_cast<double>(places.size())));
    std::vector<OutermostPlace> left;
    for (const OutermostPlace& p : places)
      if (inside(p) <= most) left.push_back(p);
    if (left.size() == places.size() || left.size() < 3) return {std::move(fit), trail, places.size()};
    places = std::move(left);
  }
}

}  // namespace

BeadWalls walls_from_beads(const TrajectorySource& trajectory) {
  const TrajectoryInfo& info = trajectory.info();
  std::map<long, std::vector<std::pair<double, double>>> left, right;  // slice -> (z, x)
  Frame frame;
  const double middle = 0.5 * (info.box.lower.x() + info.box.upper.x());
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    trajectory.read(f, frame);
    const double plate = plate_height(info, frame).value_or(0),
                 aside = sideways_displacement(info, frame).x();
    for (std::size_t i = 0; i < info.n_beads; ++i) {
      if (!frame.present(i) || !std::isfinite(frame.position[i].x())) continue;
      const double r = radius_of(info.radius, i), x = frame.position[i].x() - aside,
                   z = frame.position[i].z() - plate;
      auto& slices = x < middle ? left : right;
      slices[std::lround(std::floor(z / kSliceHeight))].emplace_back(z, x < middle ? x - r : x + r);
    }
  }
  const std::vector<OutermostPlace> l = outermost_places(left, -1), r = outermost_places(right, 1);
  if (l.size() < 3 || r.size() < 3)
    throw InputError(
        {.file = trajectory.name(), .key = {}},
        fmt::format("has enough beads at {} heights of the left and {} of the right wall; 3 are needed.",
                    l.size(), r.size()));
  const WallLine left_wall = wall_line(l, -1), right_wall = wall_line(r, 1);
  const CurveFit &left_line = left_wall.fit, &right_line = right_wall.fit;
  const auto degrees = [](double slope, double error) {
    return std::pair{std::atan(slope) * 180 / std::numbers::pi,
                     error / (1 + slope * slope) * 180 / std::numbers::pi};
  };
  BeadWalls w;
  w.x_left = left_line.fit.values[0];
  w.x_left_error = std::hypot(left_line.fit.standard_error("a"), left_wall.trail);
  w.x_right_error = std::hypot(right_line.fit.standard_error("a"), right_wall.trail);
  w.width = right_line.fit.values[0] - left_line.fit.values[0];
  w.width_error = std::hypot(w.x_left_error, w.x_right_error);
  std::tie(w.tilt_left, w.tilt_left_error) =
      degrees(-left_line.fit.values[1], left_line.fit.standard_error("b"));
  std::tie(w.tilt_right, w.tilt_right_error) =
      degrees(right_line.fit.values[1], right_line.fit.standard_error("b"));
  w.rows = std::min(left_wall.slices, right_wall.slices);
  return w;
}

}  // namespace twincell::calibration
