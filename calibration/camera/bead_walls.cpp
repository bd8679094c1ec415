#include "calibration/camera/bead_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

#include "calibration/fit/curve_fit.hpp"
#include "core/error.hpp"
#include "trajectory/plate.hpp"

namespace twincell::calibration {
namespace {

constexpr double kSliceHeight = 0.5;  // sigma
constexpr std::size_t kMinBeadsOfSlice = 20;

/// Height and outermost surface position of each slice. \param sign -1 for the left wall, +1 for the right
/// wall
std::vector<DataPoint> outermost_places(const std::map<long, std::vector<std::pair<double, double>>>& slices,
                                        double sign) {
  std::vector<DataPoint> points;
  for (auto [slice, beads] : slices) {
    if (beads.size() < kMinBeadsOfSlice) continue;
    std::sort(beads.begin(), beads.end(),
              [&](const auto& a, const auto& b) { return sign * a.second > sign * b.second; });
    const std::size_t n = std::max<std::size_t>(3, beads.size() / 100);
    double z = 0, x = 0;
    for (std::size_t i = 0; i < n; ++i) {
      z += beads[i].first / static_cast<double>(n);
      x += beads[i].second / static_cast<double>(n);
    }
    points.push_back({z, x, 0, 0});
  }
  return points;
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
  const std::vector<DataPoint> l = outermost_places(left, -1), r = outermost_places(right, 1);
  if (l.size() < 3 || r.size() < 3)
    throw InputError(
        {.file = trajectory.name(), .key = {}},
        fmt::format("has enough beads at {} heights of the left and {} of the right wall; 3 are needed.",
                    l.size(), r.size()));
  // x = a + b z
  const CurveFit left_line = fit_curve(law_named("line"), l), right_line = fit_curve(law_named("line"), r);
  const auto degrees = [](double slope, double error) {
    return std::pair{std::atan(slope) * 180 / std::numbers::pi,
                     error / (1 + slope * slope) * 180 / std::numbers::pi};
  };
  BeadWalls w;
  w.x_left = left_line.fit.values[0];
  w.x_left_error = left_line.fit.standard_error("a");
  w.x_right_error = right_line.fit.standard_error("a");
  w.width = right_line.fit.values[0] - left_line.fit.values[0];
  w.width_error = std::hypot(w.x_left_error, w.x_right_error);
  std::tie(w.tilt_left, w.tilt_left_error) =
      degrees(-left_line.fit.values[1], left_line.fit.standard_error("b"));
  std::tie(w.tilt_right, w.tilt_right_error) =
      degrees(right_line.fit.values[1], right_line.fit.standard_error("b"));
  w.rows = std::min(l.size(), r.size());
  return w;
}

}  // namespace twincell::calibration
