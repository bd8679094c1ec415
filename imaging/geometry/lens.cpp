#include "imaging/geometry/lens.hpp"

#include <cmath>
#include <numbers>

namespace twincell::imaging {

Lens::Lens(cv::Size size, double rotation_deg, double distortion)
    : middle_x_(0.5 * (size.width - 1)),
      middle_y_(0.5 * (size.height - 1)),
      unit_(0.5 * std::hypot(size.width, size.height)),
      k1_(distortion) {
  // Quarter turns use exact values, so that they do not change any digit.
  const double quarters = rotation_deg / 90;
  if (quarters == std::round(quarters)) {
    const int n = ((static_cast<int>(quarters) % 4) + 4) % 4;
    cos_ = n == 0 ? 1 : n == 2 ? -1 : 0;
    sin_ = n == 1 ? 1 : n == 3 ? -1 : 0;
  } else {
    cos_ = std::cos(rotation_deg * std::numbers::pi / 180);
    sin_ = std::sin(rotation_deg * std::numbers::pi / 180);
  }
}

PixelPoint Lens::picture_from_ideal(PixelPoint p) const {
  const double x = p.x_px - middle_x_, y = p.y_px - middle_y_;  // y points down: counter-clockwise as seen
  const double u = cos_ * x + sin_ * y, v = cos_ * y - sin_ * x;
  const double stretch = 1 + k1_ * (u * u + v * v) / (unit_ * unit_);
  return {middle_x_ + stretch * u, middle_y_ + stretch * v};
}

PixelPoint Lens::ideal_from_picture(PixelPoint p) const {
  double u = p.x_px - middle_x_, v = p.y_px - middle_y_;
  if (k1_ != 0) {
    const double seen = std::hypot(u, v) / unit_;
    double r = seen;
    for (int i = 0; i < 8; ++i) {  // Newton on r (1 + k1 r^2) = seen; monotonic for |k1| <= 0.2 and r < 1.29
      const double step = (r * (1 + k1_ * r * r) - seen) / (1 + 3 * k1_ * r * r);
      r -= step;
      if (std::abs(step) < 1e-14) break;
    }
    const double shrink = seen > 0 ? r / seen : 1;
    u *= shrink;
    v *= shrink;
  }
  return {middle_x_ + cos_ * u - sin_ * v, middle_y_ + sin_ * u + cos_ * v};
}

double Lens::magnification(PixelPoint p) const {
  const double x = p.x_px - middle_x_, y = p.y_px - middle_y_, r2 = (x * x + y * y) / (unit_ * unit_);
  return std::sqrt((1 + k1_ * r2) * (1 + 3 * k1_ * r2));
}

}  // namespace twincell::imaging
