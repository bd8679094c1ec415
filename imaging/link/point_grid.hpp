#pragma once
/// \file
/// Search of points within a given distance.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "imaging/geometry/pixel_point.hpp"

namespace twincell::imaging {

/// Median of each coordinate; reorders the points. 0 if there are no points.
PixelPoint median(std::vector<PixelPoint>& points);

/// Points sorted into square cells, for the search of points within a given distance.
class PointGrid {
 public:
  /// \param cell side of a cell, px, > 0; longer if a few points are far away
  PointGrid(std::span<const PixelPoint> points, double cell);
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  /// Point k in the order of the grid, which differs from that of the given points.
  [[nodiscard]] PixelPoint operator[](std::size_t k) const { return points_[k]; }
  /// Index of point k of the grid among the given points.
  [[nodiscard]] std::size_t original(std::size_t k) const { return static_cast<std::size_t>(original_[k]); }

  /// Calls visit(k, squared distance, px^2) for all points within `reach`, px.
  template <class Visit>
  void within(PixelPoint p, double reach, Visit&& visit) const {
    if (points_.empty()) return;
    const int i0 = column(p.x_px - reach), i1 = column(p.x_px + reach);
    const int j1 = row(p.y_px + reach);
    const double most = reach * reach;
    for (int j = row(p.y_px - reach); j <= j1; ++j) {
      const auto end = first_[static_cast<std::size_t>(j * nx_ + i1) + 1];
      for (auto k = first_[static_cast<std::size_t>(j * nx_ + i0)]; k < end; ++k) {
        const double r2 = square(points_[static_cast<std::size_t>(k)] - p);
        if (r2 <= most) visit(static_cast<std::size_t>(k), r2);
      }
    }
  }

 private:
  // Clamped, so that a search outside the grid uses the cells at its rim.
  [[nodiscard]] int column(double x) const {
    return static_cast<int>(std::clamp((x - x0_) * inverse_, 0.0, static_cast<double>(nx_ - 1)));
  }
  [[nodiscard]] int row(double y) const {
    return static_cast<int>(std::clamp((y - y0_) * inverse_, 0.0, static_cast<double>(ny_ - 1)));
  }
  double size_, inverse_ = 0, x0_ = 0, y0_ = 0;
  int nx_ = 1, ny_ = 1;
  std::vector<std::int32_t> first_, original_;
  std::vector<PixelPoint> points_;
};

}  // namespace twincell::imaging
