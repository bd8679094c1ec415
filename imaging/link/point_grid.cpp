#include "imaging/link/point_grid.hpp"

#include <numeric>

namespace twincell::imaging {

PixelPoint median(std::vector<PixelPoint>& points) {
  if (points.empty()) return {};
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](PixelPoint a, PixelPoint b) { return a.x_px < b.x_px; });
  const double x = middle->x_px;
  std::nth_element(points.begin(), middle, points.end(),
                   [](PixelPoint a, PixelPoint b) { return a.y_px < b.y_px; });
  return {x, middle->y_px};
}

PointGrid::PointGrid(std::span<const PixelPoint> points, double cell) : size_(cell) {
  const std::size_t n = points.size();
  double x1 = 0, y1 = 0;
  if (n > 0) {
    x0_ = x1 = points[0].x_px;
    y0_ = y1 = points[0].y_px;
  }
  for (const PixelPoint p : points) {
    x0_ = std::min(x0_, p.x_px);
    x1 = std::max(x1, p.x_px);
    y0_ = std::min(y0_, p.y_px);
    y1 = std::max(y1, p.y_px);
  }
  // A few distant outliers must not cost memory.
  const double most = 4.0 * static_cast<double>(n) + 1024;
  while (((x1 - x0_) / size_ + 1) * ((y1 - y0_) / size_ + 1) > most) size_ *= 1.5;
  inverse_ = 1 / size_;
  nx_ = static_cast<int>((x1 - x0_) * inverse_) + 1;
  ny_ = static_cast<int>((y1 - y0_) * inverse_) + 1;
  first_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) + 1, 0);
  std::vector<std::int32_t> cell_of(n);
  for (std::size_t i = 0; i < n; ++i) {
    cell_of[i] = row(points[i].y_px) * nx_ + column(points[i].x_px);
    ++first_[static_cast<std::size_t>(cell_of[i]) + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
  points_.resize(n);
  original_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of[i])]++);
    points_[k] = points[i];
    original_[k] = static_cast<std::int32_t>(i);
  }
}

}  // namespace twincell::imaging
