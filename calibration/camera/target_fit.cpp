#include "calibration/camera/target_fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace twincell::calibration {
namespace {

struct PointResidual {
  double a, b;  // spacings from the target's centre
  imaging::PixelPoint seen;
  cv::Size size;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    const double mx = 0.5 * (size.width - 1), my = 0.5 * (size.height - 1),
                 unit = 0.5 * std::hypot(size.width, size.height);
    // Both b and y increase downwards.
    const T u = p[0] * a, v = p[0] * b, w = 1.0 + p[4] * u + p[5] * v;
    const T x = p[1] + u / w - mx, y = p[2] + v / w - my;
    const T c = cos(p[3] * (std::numbers::pi / 180)), s = sin(p[3] * (std::numbers::pi / 180));
    const T turned_x = c * x + s * y, turned_y = c * y - s * x;
    const T stretch = 1.0 + p[6] * (turned_x * turned_x + turned_y * turned_y) / (unit * unit);
    residual[0] = mx + stretch * turned_x - seen.x_px;
    residual[1] = my + stretch * turned_y - seen.y_px;
    return true;
  }
};

}  // namespace

TargetFit fit_target(const std::vector<imaging::PixelPoint>& points, const imaging::TargetPattern& pattern,
                     cv::Size picture) {
  const auto columns = static_cast<std::size_t>(pattern.columns),
             rows = static_cast<std::size_t>(pattern.rows);
  if (points.size() != columns * rows || columns < 3 || rows < 3)
    throw InputError(
        {.file = {}, .key = "target"},
        fmt::format("shows {} of {} x {} points; each side needs at least 3.", points.size(), columns, rows));
  const imaging::PixelPoint &first = points.front(), &along = points[columns - 1], &last = points.back();
  const double dx = along.x_px - first.x_px, dy = along.y_px - first.y_px;
  double p[7] = {std::hypot(dx, dy) / static_cast<double>(columns - 1),
                 0.5 * (first.x_px + last.x_px),
                 0.5 * (first.y_px + last.y_px),
                 -std::atan2(dy, dx) * 180 / std::numbers::pi,
                 0,
                 0,
                 0};
  // Start value of the centre in the ideal picture: undoing the rotation moves it.
  const double mx = 0.5 * (picture.width - 1), my = 0.5 * (picture.height - 1),
               angle = p[3] * std::numbers::pi / 180;
  const double u = p[1] - mx, v = p[2] - my;
  p[1] = mx + std::cos(angle) * u - std::sin(angle) * v;
  p[2] = my + std::sin(angle) * u + std::cos(angle) * v;
  ceres::Problem problem;
  std::vector<PointResidual> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    all.push_back({static_cast<double>(i % columns) - 0.5 * static_cast<double>(columns - 1),
                   static_cast<double>(i / columns) - 0.5 * static_cast<double>(rows - 1), points[i],
                   picture});
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PointResidual, 2, 7>(new PointResidual(all.back())), nullptr, p);
  }
  TargetFit t;
  t.fit = solve(problem, p,
                {"pixels_per_spacing", "x0", "y0", "rotation", "gradient_x", "gradient_y", "distortion"});
  t.rms_px = t.fit.rms();
  for (const PointResidual& point : all) {
    double r[2];
    point(t.fit.values.data(), r);
    t.residuals.push_back({point.seen, std::hypot(r[0], r[1])});
  }
  return t;
}

}  // namespace twincell::calibration
