#include "imaging/disc_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/trajectory/median.hpp"

namespace twincell {

namespace {

/// Calls use(row, first, last) for the pixels of the frame nearer than `reach` to the centre.
template <class Use>
void over_disc(cv::Size size, const Detection& b, double reach, Use&& use) {
  const int last_row = std::min(size.height - 1, cvFloor(b.y + reach));
  for (int y = std::max(0, cvCeil(b.y - reach)); y <= last_row; ++y) {
    const double half = std::sqrt(std::max(0.0, reach * reach - (y - b.y) * (y - b.y)));
    const int first = std::max(0, cvCeil(b.x - half)), last = std::min(size.width - 1, cvFloor(b.x + half));
    if (first <= last) use(y, first, last);
  }
}

double interior(const Prepared& image, const Detection& b) {
  std::vector<float> inside;
  over_disc(image.darkness.size(), b, std::max(0.5 * b.radius, 1.0), [&](int y, int first, int last) {
    inside.insert(inside.end(), image.darkness[y] + first, image.darkness[y] + last + 1);
  });
  if (inside.empty()) return b.darkness;  // centre outside the frame: the rim speaks for it
  return static_cast<double>(upper_median(std::move(inside)));
}

}  // namespace

void measure_disc(const Prepared& image, Detection& b) {
  b.interior = interior(image, b);
  const cv::Size size = image.darkness.size();
  double xx = 0, xy = 0, yy = 0, mass = 0, raw = 0, signal = 0;
  over_disc(size, b, b.radius, [&](int y, int first, int last) {
    const float* d = image.darkness[y];
    const SurfaceRow light = surface_row(image.light, y, size);
    const double dy = y - b.y;
    for (int x = first; x <= last; ++x) {
      const double dx = x - b.x, v = std::max(0.0, static_cast<double>(d[x]));
      mass += v;
      raw += v * static_cast<double>(light.at(x));
      signal = std::max(signal, v);
      xx += v * dx * dx;
      xy += v * dx * dy;
      yy += v * dy * dy;
    }
  });
  b.mass = mass;
  b.raw_mass = raw;
  b.signal = signal;
  if (mass <= 0) return;
  b.size = std::sqrt((xx + yy) / mass);
  const double spread = std::hypot(xx - yy, 2 * xy), sum = xx + yy;
  b.ecc = sum + spread > 0 ? std::sqrt(2 * spread / (sum + spread)) : 0;
}

double rough_interior(const Prepared& image, const Detection& b) {
  std::array<float, 9> v{};
  std::ptrdiff_t n = 0;
  const int away = std::max(1, cvFloor(0.4 * b.radius));
  for (int dy = -away; dy <= away; dy += away)
    for (int dx = -away; dx <= away; dx += away) {
      const int x = cvRound(b.x) + dx, y = cvRound(b.y) + dy;
      if (x >= 0 && y >= 0 && x < image.darkness.cols && y < image.darkness.rows)
        v[static_cast<std::size_t>(n++)] = image.darkness(y, x);
    }
  if (n == 0) return 1;
  std::nth_element(v.begin(), v.begin() + n / 2, v.begin() + n);
  return static_cast<double>(v[static_cast<std::size_t>(n / 2)]);
}

bool in_wall(const Prepared& image, const Detection& b) {
  const cv::Point at(cvRound(b.x), cvRound(b.y));
  const cv::Mat1b& walls = image.opaque;
  return cv::Rect(0, 0, walls.cols, walls.rows).contains(at) && walls(at) != 0;
}

}  // namespace twincell
