#include "imaging/camera/dirt.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "imaging/camera/random.hpp"

namespace twincell::imaging {

namespace {

// Darkens by `depth` where the distance from the segment a-b is below `half_width`; the edges are blurred.
void darken(cv::Mat1f& glass, cv::Point2d a, cv::Point2d b, double half_width, double depth, double blur) {
  const double reach = half_width + 5 * blur, edge = std::numbers::sqrt2 * blur;
  const cv::Point2d along = b - a;
  const double length2 = along.dot(along);
  for (int y = std::max(0, cvFloor(std::min(a.y, b.y) - reach));
       y <= std::min(glass.rows - 1, cvCeil(std::max(a.y, b.y) + reach)); ++y)
    for (int x = std::max(0, cvFloor(std::min(a.x, b.x) - reach));
         x <= std::min(glass.cols - 1, cvCeil(std::max(a.x, b.x) + reach)); ++x) {
      const cv::Point2d p = cv::Point2d(x, y) - a;
      const double t = length2 > 0 ? std::clamp(p.dot(along) / length2, 0.0, 1.0) : 0;
      const double r = cv::norm(p - t * along);
      if (r > reach) continue;
      const double share = 0.5 * (std::erf((r + half_width) / edge) - std::erf((r - half_width) / edge));
      glass(y, x) *= static_cast<float>(1 - depth * share);
    }
}

}  // namespace

cv::Mat1f glass(cv::Size size, const CameraOptions& o) {
  cv::Mat1f light(size, 1.0F);
  for (int i = 0; i < o.dust; ++i) {
    RandomStream chance(o.seed, Chance::dirt, 0, i);
    const cv::Point2d at(chance.uniform(0, size.width), chance.uniform(0, size.height));
    const double radius = chance.uniform(0.5, 4);
    darken(light, at, at, radius, chance.uniform(0.2, 0.8), o.blur_px);
  }
  for (int i = 0; i < o.scratches; ++i) {
    RandomStream chance(o.seed, Chance::dirt, 1, i);
    const cv::Point2d at(chance.uniform(0, size.width), chance.uniform(0, size.height));
    const double angle = chance.uniform(0, std::numbers::pi),
                 length = chance.uniform(30, std::max(31.0, 0.5 * size.height));
    const double width = chance.uniform(0.5, 1.5);
    darken(light, at, at + length * cv::Point2d(std::cos(angle), std::sin(angle)), 0.5 * width,
           chance.uniform(0.1, 0.5), o.blur_px);
  }
  return light;
}

}  // namespace twincell::imaging
