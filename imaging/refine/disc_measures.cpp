#include "imaging/refine/disc_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/median.hpp"
#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell::imaging {

namespace {

/// Calls use(y, first, last) for each row of pixels of the frame within `reach` of the centre.
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
  constexpr std::size_t kFewPixels = 64;  // kept in an array
  std::array<float, kFewPixels> few{};
  std::vector<float> many;
  std::size_t n = 0;
  // For larger discs every other pixel, in a chessboard pattern, suffices for the median.
  constexpr double kMaxDenseReach = 3;  // px
  const double reach = std::max(0.5 * b.radius, 1.0);
  const int stride = reach > kMaxDenseReach ? 2 : 1;
  over_disc(image.darkness.size(), b, reach, [&](int y, int first, int last) {
    const float* row = image.darkness[y];
    for (int x = first + ((first + y) & (stride - 1)); x <= last; x += stride, ++n) {
      if (n < kFewPixels) {
        few[n] = row[x];
        continue;
      }
      if (n == kFewPixels) many.assign(few.begin(), few.end());
      many.push_back(row[x]);
    }
  });
  if (n == 0) return b.darkness;  // centre outside the frame: use the fit of the rim
  return static_cast<double>(n > kFewPixels ? upper_median(std::move(many)) : upper_median_of_few(few, n));
}

/// Sum of v B. B is a quadratic surface, so its Taylor coefficients at the centre and the moments of the disc
/// give the sum exactly.
double light_taken(const Surface& light, cv::Size size, const Detection& b, const DiscMoments& m) {
  const Surface at = surface_basis(b.x, b.y, size);
  const double u = at[1], v = at[2];
  const double du = size.width > 1 ? 2.0 / (size.width - 1) : 0,
               dv = size.height > 1 ? 2.0 / (size.height - 1) : 0;
  return light.dot(at) * m.mass + (light[1] + 2 * light[3] * u + light[4] * v) * du * m.x +
         (light[2] + light[4] * u + 2 * light[5] * v) * dv * m.y + light[3] * du * du * m.xx +
         light[4] * du * dv * m.xy + light[5] * dv * dv * m.yy;
}

}  // namespace

void measure_disc(const Prepared& image, Detection& b) {
  b.interior = interior(image, b);
  const cv::Size size = image.darkness.size();
  const DiscMoments m = disc_moments(image.darkness, size, {b.x, b.y, b.radius, b.darkness});
  b.mass = m.mass;
  b.raw_mass = light_taken(image.light, size, b, m);
  b.signal = m.most;
  if (m.mass <= 0) return;
  const double sum = m.xx + m.yy, spread = std::sqrt((m.xx - m.yy) * (m.xx - m.yy) + 4 * m.xy * m.xy);
  b.size = std::sqrt(sum / m.mass);
  b.ecc = sum + spread > 0 ? std::sqrt(2 * spread / (sum + spread)) : 0;
}

double rough_interior(const Prepared& image, const Detection& b) {
  std::array<float, 16> v{};
  std::size_t n = 0;
  const int away = std::max(1, cvFloor(0.4 * b.radius));
  for (int dy = -away; dy <= away; dy += away)
    for (int dx = -away; dx <= away; dx += away) {
      const int x = cvRound(b.x) + dx, y = cvRound(b.y) + dy;
      if (x >= 0 && y >= 0 && x < image.darkness.cols && y < image.darkness.rows)
        v[n++] = image.darkness(y, x);
    }
  if (n == 0) return 1;
  return static_cast<double>(upper_median_of_few(v, n));
}

bool in_wall(const Prepared& image, const Detection& b) {
  const cv::Point at(cvRound(b.x), cvRound(b.y));
  const cv::Mat1b& walls = image.opaque;
  return cv::Rect(0, 0, walls.cols, walls.rows).contains(at) && walls(at) != 0;
}

}  // namespace twincell::imaging
